#include <pthread.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/systemd_link.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

struct IsolateOptions {
  std::string deployment;
  int domain_id = 0;
  std::vector<std::string> interfaces;
  bool given = false;
};

// Until one of the signals that end a process.
void Hold(const IsolateOptions& options) {
  sigset_t ends;
  sigemptyset(&ends);
  for (const int signal : {SIGINT, SIGTERM, SIGQUIT, SIGHUP}) sigaddset(&ends, signal);
  ::pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  isolation::Isolation held(options.deployment, options.interfaces,
                            options.given ? isolation::Network::kGiven : isolation::Network::kNew);
  isolation::BecomeHolder();
  node::SystemdLink systemd;
  systemd.SetStatus("holds the network of " + options.deployment);
  std::cout << "isolated: " << options.deployment << ", process " << ::getpid() << std::endl;
  constexpr timespec kLook{.tv_sec = 1, .tv_nsec = 0};
  std::string said;
  while (::sigtimedwait(&ends, nullptr, &kLook) < 0) {
    try {
      held.MoveIn();
    } catch (const UsageError& error) {
      if (std::exchange(said, error.what()) != error.what()) std::cerr << said << std::endl;
    }
  }
}

void AddIsolate(CLI::App& app) {
  auto options = std::make_shared<IsolateOptions>();
  CLI::App* command = app.add_subcommand("isolate", "Hold a network of a deployment's own");
  command->add_option("deployment", options->deployment, "Its name")->required();
  command->add_option("--domain", options->domain_id, "Its DDS domain, 0 to 232")
      ->required()
      ->check(CLI::Range(0, 232));
  command->add_option("--move", options->interfaces, "Interface that moves in; may be repeated")
      ->type_name("NAME");
  command->add_flag("--given", options->given,
                    "The network that a unit's PrivateNetwork= gives, instead of a new one");
  command->footer(
      "Other users of the host cannot send anything to what runs inside; its own user's commands\n"
      "enter by themselves. `sinew launch --isolate` starts it. Ends by SIGINT or SIGTERM, and "
      "the\n"
      "interfaces go back.\n\nExample:\n  sinew isolate rig --domain 0 --move can0");
  command->callback([options] { Hold(*options); });
}

void AddEnter(CLI::App& app) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command =
      app.add_subcommand("enter", "Run a program in the network of an isolated deployment");
  command->prefix_command();
  command->footer(
      "For programs that do not enter by themselves, as `sinew` and its participants do.\n\n"
      "Example:\n  sinew enter rig ./my_controller --verbose");
  command->callback([command] {
    std::vector<std::string> line = command->remaining();
    if (line.size() < 2) throw UsageError("sinew enter: expected NAME PROGRAM [ARGUMENT...]");
    isolation::Enter(isolation::Chosen(line.front(), 0).value());
    std::vector<char*> pointers;
    for (auto word = line.begin() + 1; word != line.end(); ++word) pointers.push_back(word->data());
    pointers.push_back(nullptr);
    ::execvp(pointers[0], pointers.data());
    throw std::runtime_error(line[1] + ": " + std::strerror(errno));
  });
}

}  // namespace

void AddIsolateCommands(CLI::App& app) {
  AddIsolate(app);
  AddEnter(app);
}

}  // namespace sinew::tools
