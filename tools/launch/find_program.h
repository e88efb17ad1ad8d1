// The file of a program that a user names, as deployments name them.
#pragma once

#include <filesystem>
#include <string>

namespace sinew::launch {

// Folder of this program: the others are beside it. Empty: not known.
std::filesystem::path ProgramFolder();

// A path (with a slash) relative to `base`, or a name beside `folder` or in PATH. Empty: not found.
std::filesystem::path FindProgram(const std::string& program, const std::filesystem::path& base,
                                  const std::filesystem::path& folder);

// The message when no program was found.
std::string NoProgram(const std::string& program, const std::filesystem::path& folder);

}  // namespace sinew::launch
