// A network and a /dev/shm of a deployment's own: namespaces of Linux (namespaces(7)) that a
// process holds, `sinew isolate NAME`. A process outside cannot send a datagram to anybody inside,
// other users of the host among them; programs of the same user enter, and files, folders and Unix
// sockets at paths are the host's as before.
//
// Without root the namespaces belong to a user namespace, in which nobody has more rights than
// before; interfaces are moved by root only.
//
// Set-up only; functions that change the process want it to have one thread, and throw UsageError.
#pragma once

#include <sys/types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sinew::isolation {

// A process that holds the network of a deployment.
struct Holder {
  pid_t pid = 0;
  std::string deployment;
  int domain_id = 0;
  uid_t user = 0;
};

// Those of this process' user that are ready, by name.
std::vector<Holder> Holders();

// The holder whose network a program of `domain_id` enters. chosen: the name of a deployment,
// "none" for the host's own network, or empty: the one that runs in the domain, where there is one.
// Throws: no such deployment runs, or empty and several do.
std::optional<Holder> Chosen(const std::string& chosen, int domain_id);

// The holder whose network this process is in; nothing: it is in another one, as the host's.
std::optional<Holder> Inside();

// Isolated deployments of the domain in which this process is not, for those who hear nobody: text
// that continues a sentence ("; ..."), or empty.
std::string OthersIn(int domain_id);

// This process, and what it executes, is inside from now on. Nothing, where it is inside already.
void Enter(const Holder& holder);

enum class Network {
  kNew,    // network and /dev/shm are made, apart from those in which this process starts
  kGiven,  // they are its own already, by the manager of services; interfaces come from process 1's
};

// The namespaces of this process with the interfaces that are moved in (up again, and with their
// first IPv4 address, as they were) and a loopback that is up. They go back when this ends; when
// the process is killed, the kernel gives physical ones back, and deletes virtual ones.
class Isolation {
 public:
  // Throws, too: a deployment of that name is held already, a given network that is process 1's,
  // and, for a new one, an interface that is not there.
  Isolation(const std::string& deployment, const std::vector<std::string>& interfaces,
            Network network = Network::kNew);
  ~Isolation();
  Isolation(const Isolation&) = delete;
  Isolation& operator=(const Isolation&) = delete;

  // Those that have appeared on the host since, such as a USB adapter that was plugged in. Returns
  // when they carry frames again, if they did, or after some seconds.
  void MoveIn();

 private:
  void MakeNew(const std::vector<std::string>& interfaces);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The command line of a holder, of which this process has its name: from now on Holders() finds it.
std::vector<std::string> HolderArguments(const std::string& deployment, int domain_id,
                                         const std::vector<std::string>& interfaces);
void BecomeHolder();

}  // namespace sinew::isolation
