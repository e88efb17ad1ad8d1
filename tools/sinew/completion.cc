#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

// The scripts of the shells show what `sinew __complete WORDS...` prints (candidates.h); after "="
// and "." a word goes on.

constexpr char kBash[] =
    R"(# bash completion of sinew. Load it with:  source <(sinew completion bash)
_sinew() {
  local cur=${COMP_WORDS[COMP_CWORD]} line
  [ "$cur" != = ] || cur=''
  COMPREPLY=()
  while IFS= read -r line; do
    if [ "$line" = :files ]; then
      compopt -o filenames
      mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- "$cur")
    else
      COMPREPLY+=("${line%%$'\t'*}")
    fi
  done < <("${COMP_WORDS[0]/#~\//$HOME/}" __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=.] ]]; then compopt -o nospace; fi
}
complete -F _sinew sinew
)";

constexpr char kZsh[] = R"(#compdef sinew
# zsh completion of sinew. Load it with:  source <(sinew completion zsh)
_sinew() {
  local -a finished unfinished
  local line files=no
  for line in "${(@f)$("${${(Q)words[1]}/#\~\//$HOME/}" __complete "${(@Q)words[2,CURRENT]}" 2> /dev/null)}"; do
    case $line in
      '') ;;
      :files) files=yes ;;
      *[=.]) unfinished+=("$line") ;;
      *) finished+=("${${line//:/\\:}/$'\t'/:}") ;;
    esac
  done
  if (( $#finished )); then _describe -o sinew finished; fi
  if (( $#unfinished )); then compadd -S '' -a unfinished; fi
  if [[ $files = yes ]]; then
    compset -P '*='
    _files
  fi
}
if [ "$funcstack[1]" = _sinew ]; then _sinew "$@"; else compdef _sinew sinew; fi
)";

constexpr char kFish[] =
    R"(# fish completion of sinew. Load it with:  sinew completion fish | source
function __sinew_complete
  set -l words (commandline -opc) (commandline -ct)
  set -l program (string replace -r '^~/' "$HOME/" -- $words[1])
  for line in ($program __complete $words[2..-1] 2> /dev/null)
    if test "$line" = :files
      __fish_complete_path (commandline -ct)
    else
      echo $line
    end
  end
end
complete -c sinew -f -a '(__sinew_complete)'
)";

}  // namespace

void AddCompletionCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("completion", "Print the shell's completion script");
  command->require_subcommand(1);
  command->footer(
      "Examples:\n"
      "  source <(sinew completion bash)\n"
      "  sinew completion bash > /etc/bash_completion.d/sinew\n"
      "  sinew completion zsh > ~/.zfunc/_sinew\n"
      "  sinew completion fish > ~/.config/fish/completions/sinew.fish");
  const auto add = [command](const char* shell, const char* script) {
    command->add_subcommand(shell, std::string("For ") + shell)->callback([script] {
      std::cout << script;
    });
  };
  add("bash", kBash);
  add("zsh", kZsh);
  add("fish", kFish);
}

}  // namespace sinew::tools
