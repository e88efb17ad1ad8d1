#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <regex>
#include <string>
#include <vector>

#include "components/base/types/joined.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

struct Word {
  std::vector<std::string> names;  // "--seed"; empty for a positional argument
  std::string description;
  bool takes_value = false;
  bool is_file = false;
  std::vector<std::string> choices;
};

struct Command {
  std::string path;  // "" or "model" or "model/show"
  std::string name;
  std::string description;
  std::vector<Word> options;
  std::vector<Word> positionals;
  std::vector<Command> subcommands;
};

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

// A validator of allowed words shows itself as "TEXT:{a,b}".
std::vector<std::string> Choices(const std::string& type_name) {
  std::vector<std::string> words;
  const std::size_t begin = type_name.find('{'), end = type_name.find('}');
  if (begin == std::string::npos || end == std::string::npos) return words;
  std::string word;
  for (std::size_t i = begin + 1; i <= end; ++i) {
    if (type_name[i] != ',' && i != end) {
      word += type_name[i];
    } else if (!word.empty()) {
      words.push_back(word);
      word.clear();
    }
  }
  return words;
}

// By its type, or by what its help says of the value.
bool NamesFile(const CLI::Option& option) {
  static const std::regex kType("FILE|DIR|PATH");
  static const std::regex kHelp("\\b(file|files|folder|recordings?|CSV|MCAP|URDF)\\b",
                                std::regex::icase);
  return std::regex_search(option.get_type_name(), kType) ||
         std::regex_search(option.get_description(), kHelp);
}

Command Describe(const CLI::App& app, const std::string& path) {
  Command command;
  command.path = path;
  command.name = app.get_name();
  command.description = FirstLine(app.get_description());
  for (const CLI::Option* option : app.get_options([](const CLI::Option*) { return true; })) {
    if (option->get_group().empty()) continue;  // hidden
    Word word;
    for (const std::string& name : option->get_lnames()) word.names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) word.names.push_back("-" + name);
    word.description = FirstLine(option->get_description());
    word.takes_value = option->get_items_expected_max() > 0;
    word.choices = Choices(option->get_type_name());
    word.is_file = word.takes_value && word.choices.empty() && NamesFile(*option);
    (word.names.empty() ? command.positionals : command.options).push_back(std::move(word));
  }
  for (const CLI::App* child : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (child->get_name().empty() || child->get_group().empty()) continue;
    command.subcommands.push_back(
        Describe(*child, path.empty() ? child->get_name() : path + "/" + child->get_name()));
  }
  return command;
}

void ForEach(const Command& command, const std::function<void(const Command&)>& visit) {
  visit(command);
  for (const Command& child : command.subcommands) ForEach(child, visit);
}

// ---- bash

std::string BashScript(const Command& root) {
  std::string walk, words, values;
  ForEach(root, [&](const Command& command) {
    std::vector<std::string> list;
    for (const Command& child : command.subcommands) {
      walk += "      '" + command.path + " " + child.name + "') path='" + child.path + "' ;;\n";
      list.push_back(child.name);
    }
    bool files = false;
    for (const Word& positional : command.positionals) {
      files = files || positional.is_file;
      list.insert(list.end(), positional.choices.begin(), positional.choices.end());
    }
    for (const Word& option : command.options) {
      list.insert(list.end(), option.names.begin(), option.names.end());
      if (!option.takes_value) continue;
      std::vector<std::string> keys;
      for (const std::string& name : option.names) {
        keys.push_back("'" + command.path + " " + name + "'");
      }
      values += "    " + types::Joined(keys, "|") + ") ";
      if (option.is_file) {
        values += "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$cur\"))";
      } else {
        values +=
            "COMPREPLY=($(compgen -W '" + types::Joined(option.choices, " ") + "' -- \"$cur\"))";
      }
      values += "; return ;;\n";
    }
    words += "    '" + command.path + "') words='" + types::Joined(list, " ") +
             "'; files=" + (files ? "yes" : "no") + " ;;\n";
  });
  return "# bash completion of sinew. Load it with:  source <(sinew completion bash)\n"
         "_sinew() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} prev='' path='' words='' files=no i\n"
         "  [ \"$COMP_CWORD\" -gt 0 ] && prev=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  if [ \"$cur\" = '=' ]; then cur=''\n"
         "  elif [ \"$prev\" = '=' ]; then prev=${COMP_WORDS[COMP_CWORD - 2]}\n"
         "  fi\n"
         "  COMPREPLY=()\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"$path ${COMP_WORDS[i]}\" in\n" +
         walk +
         "    esac\n"
         "  done\n"
         "  case \"$path $prev\" in\n" +
         values +
         "  esac\n"
         "  case \"$path\" in\n" +
         words +
         "  esac\n"
         "  if [[ $cur != -* && $files = yes ]]; then\n"
         "    compopt -o filenames\n"
         "    COMPREPLY=($(compgen -f -- \"$cur\"))\n"
         "  else\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
         "  fi\n"
         "}\n"
         "complete -F _sinew sinew\n";
}

// ---- zsh

std::string ZshText(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'') {
      safe += "'\\''";
    } else if (c == '[' || c == ']' || c == ':' || c == '\\') {
      safe += std::string("\\") + c;
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string ZshValue(const Word& word) {
  if (word.is_file) return "_files";
  return word.choices.empty() ? " " : "(" + types::Joined(word.choices, " ") + ")";
}

std::string ZshFunction(const std::string& path) {
  std::string name = "_sinew";
  if (!path.empty()) name += "_" + path;
  for (char& c : name) c = c == '/' || c == '-' ? '_' : c;
  return name;
}

std::string ZshScript(const Command& root) {
  std::string script =
      "#compdef sinew\n# zsh completion of sinew. Load it with:  source <(sinew completion zsh)\n";
  ForEach(root, [&script](const Command& command) {
    script += ZshFunction(command.path) + "() {\n  local curcontext=\"$curcontext\" state line\n";
    script += "  _arguments -C";
    for (const Word& option : command.options) {
      for (const std::string& name : option.names) {
        script += " \\\n    '*" + name + "[" + ZshText(option.description) + "]" +
                  (option.takes_value ? ":value:" + ZshValue(option) : "") + "'";
      }
    }
    if (!command.subcommands.empty()) {
      script += " \\\n    '1:command:((";
      for (const Command& child : command.subcommands) {
        script += child.name + "\\:\"" + ZshText(child.description) + "\" ";
      }
      script +=
          "))' \\\n    '*::argument:->argument'\n  case $state in argument) case $line[1] in\n";
      for (const Command& child : command.subcommands) {
        script += "    " + child.name + ") " + ZshFunction(child.path) + " ;;\n";
      }
      script += "  esac ;; esac\n";
    } else {
      for (const Word& positional : command.positionals) {
        script +=
            " \\\n    '*:" + ZshText(positional.description) + ":" + ZshValue(positional) + "'";
        break;
      }
      script += "\n";
    }
    script += "}\n";
  });
  return script +
         "if [ \"$funcstack[1]\" = _sinew ]; then _sinew \"$@\"; else compdef _sinew sinew; fi\n";
}

}  // namespace

void AddCompletionCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print the shell's completion script");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  source <(sinew completion bash)\n"
      "  sinew completion bash > /etc/bash_completion.d/sinew\n"
      "  sinew completion zsh > ~/.zfunc/_sinew");
  command->add_subcommand("bash", "For bash")->callback([&app] {
    std::cout << BashScript(Describe(app, ""));
  });
  command->add_subcommand("zsh", "For zsh")->callback([&app] {
    std::cout << ZshScript(Describe(app, ""));
  });
}

}  // namespace sinew::tools
