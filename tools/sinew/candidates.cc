#include "tools/sinew/candidates.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <exception>
#include <iostream>
#include <map>
#include <regex>

#include "components/base/config/config.h"
#include "components/model/effects/effect.h"
#include "components/record/recording/idl_schema.h"
#include "components/topics/node/topics.h"
#include "tools/launch/deployment.h"

namespace sinew::tools {

namespace {

struct Candidate {
  std::string text;
  std::string description;  // of commands and options only
};
using Candidates = std::vector<Candidate>;

struct Typed {
  const CLI::App* root = nullptr;
  const CLI::App* command = nullptr;          // the one in use
  const CLI::Option* option = nullptr;        // its value is typed last; nullptr: none is open
  std::vector<std::string> positionals;       // before the last word
  std::map<std::string, std::string> values;  // of options, by the name as typed
  std::string before;                         // of the last word: "--mode=", "joint_state,"
  std::string word;                           // the rest of it
};

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

const CLI::App* ChildNamed(const CLI::App& app, const std::string& name) {
  for (const CLI::App* child : app.get_subcommands({})) {
    if (child->get_name() == name) return child;
  }
  return nullptr;
}

bool TakesMore(const CLI::Option& option, int taken) {
  return taken < option.get_items_expected_min() ||
         (option.get_allow_extra_args() && taken < option.get_items_expected_max());
}

Typed ReadWords(const CLI::App& root, const std::vector<std::string>& words) {
  Typed typed{.root = &root, .command = &root};
  int taken = 0;
  std::string name;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    const bool last = i + 1 == words.size(), dashed = word.starts_with('-');
    if (last) typed.word = word;
    if (typed.option != nullptr && (taken == 0 || !dashed)) {
      if (last) break;
      typed.values[name] = word;
      if (!TakesMore(*typed.option, ++taken)) typed.option = nullptr;
      continue;
    }
    typed.option = nullptr;
    if (dashed) {
      const std::size_t equals = word.find('=');
      name = word.substr(0, equals);
      const CLI::Option* option = typed.command->get_option_no_throw(name);
      if (option == nullptr || option->get_items_expected_max() == 0) continue;
      if (equals == std::string::npos) {
        if (!last) typed.option = option;
        taken = 0;
      } else if (last) {
        typed.option = option;
        typed.before = word.substr(0, equals + 1);
        typed.word = word.substr(equals + 1);
      } else {
        typed.values[name] = word.substr(equals + 1);
      }
    } else if (const CLI::App* child = last ? nullptr : ChildNamed(*typed.command, word)) {
      typed.command = child;
      typed.positionals.clear();
      typed.values.clear();
    } else if (!last) {
      typed.positionals.push_back(word);
    }
  }
  return typed;
}

// ---- Values

Candidates Plain(const std::vector<std::string>& texts, const std::string& after = "") {
  Candidates candidates;
  for (const std::string& text : texts) candidates.push_back({text + after, ""});
  return candidates;
}

std::vector<std::string> SplitAt(const std::string& text, const std::string& separators) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  while ((begin = text.find_first_not_of(separators, begin)) != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

// A list is offered as a whole and by its first entry.
void AddFields(const recording::IdlType& type, const std::string& path, Candidates* fields) {
  using Kind = recording::IdlType::Kind;
  if (type.kind == Kind::kStruct) {
    for (const recording::IdlMember& member : type.members) {
      AddFields(*member.type, (path.empty() ? "" : path + ".") + member.name, fields);
    }
    return;
  }
  const bool is_list = type.kind == Kind::kSequence || type.kind == Kind::kArray;
  if (!is_list || type.element->kind != Kind::kStruct) fields->push_back({path, ""});
  if (is_list) AddFields(*type.element, path + "[0]", fields);
}

Candidates FieldsOf(const node::TopicInfo& topic) {
  Candidates fields;
  AddFields(recording::IdlSchema::Parse(topic.idl).Struct(topic.type_name), "", &fields);
  return fields;
}

Candidates Topics(const Typed&, const CLI::Option&) {
  Candidates topics;
  for (const node::TopicInfo& topic : node::AllTopics()) topics.push_back({topic.name, ""});
  return topics;
}

// Topics, as "joint_state.", until one is left: then its fields.
Candidates TopicFields(const Typed& typed, const CLI::Option&) {
  Candidates found;
  const node::TopicInfo* only = nullptr;
  for (const node::TopicInfo& topic : node::AllTopics()) {
    const std::string start = topic.name + ".";
    if (!start.starts_with(typed.word) && !typed.word.starts_with(start)) continue;
    found.push_back({start, ""});
    only = &topic;
  }
  if (found.size() != 1) return found;
  Candidates fields = FieldsOf(*only);
  for (Candidate& field : fields) field.text = found[0].text + field.text;
  return fields;
}

Candidates TopicsAndFields(const Typed& typed, const CLI::Option& option) {
  Candidates found = TopicFields(typed, option);
  if (typed.word.find('.') == std::string::npos) {
    Candidates topics = Topics(typed, option);
    if (!found.empty() && found[0].text.ends_with('.')) return topics;
    found.insert(found.begin(), topics.begin(), topics.end());
  }
  return found;
}

Candidates FieldsOfTheTopic(const Typed& typed, const CLI::Option&) {
  if (typed.positionals.empty()) return {};
  const node::TopicInfo* topic = node::FindTopic(typed.positionals.front());
  return topic == nullptr ? Candidates() : FieldsOf(*topic);
}

Candidates Effects(const Typed&, const CLI::Option&) { return Plain(effects::EffectNames()); }

// Names of the deployment that the command line has; none while it cannot be read.
std::vector<std::string> ProcessNames(const Typed& typed) try {
  const auto option = typed.values.find("--deployment");
  if (option == typed.values.end() && typed.positionals.empty()) return {};
  const std::string& file =
      option == typed.values.end() ? typed.positionals.front() : option->second;
  std::vector<std::string> names;
  const config::Section root = config::Section::Load(file, launch::kSchema);
  for (const config::Section& process : root.List("processes")) {
    const std::string name = process.Text("name");
    if (std::regex_match(name, std::regex("[\\w.-]+"))) names.push_back(name);  // not "$(...)"
  }
  return names;
} catch (const std::exception&) {
  return {};
}

Candidates Processes(const Typed& typed, const CLI::Option&) { return Plain(ProcessNames(typed)); }

Candidates ProcessArguments(const Typed& typed, const CLI::Option&) {
  return Plain(ProcessNames(typed), "=");
}

// The keys that the option's help lists; those of PROCESS for each process.
Candidates Settings(const Typed& typed, const CLI::Option& option) {
  const std::string& help = option.get_description();
  const std::string process = "PROCESS";
  Candidates settings;
  for (const std::string& key : SplitAt(help.substr(help.find(':') + 1), ", ")) {
    if (!key.starts_with(process)) {
      settings.push_back({key + "=", ""});
      continue;
    }
    for (const std::string& name : ProcessNames(typed)) {
      settings.push_back({name + key.substr(process.size()) + "=", ""});
    }
  }
  return settings;
}

Candidates CommandWords(const CLI::App& app) {
  Candidates commands;
  for (const CLI::App* child : app.get_subcommands({})) {
    if (child->get_name().empty() || child->get_group().empty()) continue;  // hidden
    commands.push_back({child->get_name(), FirstLine(child->get_description())});
  }
  return commands;
}

Candidates CommandsBelow(const Typed& typed, const CLI::Option&) {
  const CLI::App* app = typed.root;
  for (const std::string& name : typed.positionals) {
    if (app != nullptr) app = ChildNamed(*app, name);
  }
  Candidates words = app == nullptr ? Candidates() : CommandWords(*app);
  for (Candidate& word : words) word.description.clear();  // values here, not commands
  return words;
}

// Values by what type and help of an option say of them; the first pattern counts.
struct ValueSource {
  const char* pattern;
  Candidates (*candidates)(const Typed&, const CLI::Option&);
};
constexpr std::array<ValueSource, 9> kSources = {{
    {"Topic or TOPIC\\.FIELD", TopicsAndFields},
    {"\\bTOPIC\\.FIELD\\b", TopicFields},
    {"^FIELD\\b", FieldsOfTheTopic},
    {"\\bTOPIC\\b", Topics},
    {"^EFFECT\\b", Effects},
    {"^KEY=VALUE .*\\bPROCESS\\.", Settings},
    {"^PROCESS=", ProcessArguments},
    {"^PROCESS\\b", Processes},
    {"^COMMAND\\b", CommandsBelow},
}};
constexpr char kFileType[] = "FILE|DIR|PATH";
constexpr char kFileSetting[] = "^[^=]+\\.(config|program)=";
constexpr char kFileHelp[] = "\\b([Ff]iles?|[Ff]older|[Rr]ecordings?|CSV|MCAP|URDF)\\b";

struct Offer {
  Candidates candidates;
  bool files = false;
};

// known: its words come from a source.
bool NamesFile(const Typed& typed, const std::string& type, const std::string& help, bool known) {
  return std::regex_search(type, std::regex(kFileType)) ||
         (known && std::regex_search(typed.word, std::regex(kFileSetting))) ||
         (!known && std::regex_search(help, std::regex(kFileHelp)));
}

Offer ValuesOf(const Typed& typed, const CLI::Option& option) {
  const std::string type = option.get_type_name(), help = option.get_description();
  // A validator of allowed words shows itself as "TEXT:{a,b}".
  if (const std::size_t begin = type.find('{'); begin != std::string::npos) {
    return {Plain(SplitAt(type.substr(begin + 1, type.find('}') - begin - 1), ",")), false};
  }
  for (const ValueSource& source : kSources) {
    if (!std::regex_search(type + " " + help, std::regex(source.pattern))) continue;
    return {source.candidates(typed, option), NamesFile(typed, type, help, true)};
  }
  return {{}, NamesFile(typed, type, help, false)};
}

// ---- Words

Candidates OptionWords(const CLI::App& command) {
  Candidates options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    const std::string help = FirstLine(option->get_description());
    for (const std::string& name : option->get_lnames()) options.push_back({"--" + name, help});
    for (const std::string& name : option->get_snames()) options.push_back({"-" + name, help});
  }
  return options;
}

// nullptr: the command takes no further one.
const CLI::Option* NextPositional(const Typed& typed) {
  auto given = static_cast<int>(typed.positionals.size());
  for (const CLI::Option* option : typed.command->get_options()) {
    if (!option->get_positional() || option->nonpositional()) continue;
    if (given < option->get_items_expected_max()) return option;
    given -= option->get_items_expected_max();
  }
  return nullptr;
}

Offer OfferFor(Typed* typed) {
  const CLI::Option* option = typed->option;
  if (option == nullptr && typed->word.starts_with('-'))
    return {OptionWords(*typed->command), false};
  Offer commands{typed->positionals.empty() ? CommandWords(*typed->command) : Candidates(), false};
  if (option != nullptr) {
    commands.candidates.clear();
  } else if (option = NextPositional(*typed); option == nullptr) {
    if (!commands.candidates.empty()) return commands;
    return {typed->word.empty() ? OptionWords(*typed->command) : Candidates(), false};
  }
  if (option->get_delimiter() != '\0') {
    const std::size_t rest = typed->word.rfind(option->get_delimiter()) + 1;  // npos + 1 is 0
    typed->before += typed->word.substr(0, rest);
    typed->word.erase(0, rest);
  }
  Offer offer = ValuesOf(*typed, *option);
  offer.candidates.insert(offer.candidates.begin(), commands.candidates.begin(),
                          commands.candidates.end());
  return offer;
}

}  // namespace

void PrintCandidates(const CLI::App& app, const std::vector<std::string>& words) {
  // bash has "--mode=lo" as three words, and completes the last one of them.
  std::vector<std::string> joined;
  std::size_t shown_from = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool after_equals = i > 0 && words[i - 1] == "=";
    if (joined.empty() || (words[i] != "=" && !after_equals)) {
      joined.push_back(words[i]);
      shown_from = 0;
      continue;
    }
    joined.back() += words[i];
    shown_from = joined.back().size() - (after_equals ? words[i].size() : 0);
  }
  Typed typed = ReadWords(app, joined);
  const Offer offer = OfferFor(&typed);
  for (const Candidate& candidate : offer.candidates) {
    if (!candidate.text.starts_with(typed.word)) continue;
    std::cout << (typed.before + candidate.text).substr(shown_from)
              << (candidate.description.empty() ? "" : "\t") << candidate.description << '\n';
  }
  if (offer.files) std::cout << ":files\n";
}

}  // namespace sinew::tools
