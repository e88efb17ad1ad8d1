// Carries the precompiled header of the programs.
int main() {}
