// Candidates for the last word of a command line of `sinew`.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sinew::tools {

// The first argument of the program that asks for candidates. It is no command of the app: the
// words after it may be unfinished, and are not parsed.
inline constexpr char kComplete[] = "__complete";

// Prints a line for each: the word, and a tab and what it is for commands and options; ":files"
// where names of files may stand, too. words: without the program's name, the last one unfinished
// or empty. No DDS; reads the deployment that the words name.
void PrintCandidates(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace sinew::tools
