// Keeps the threads of Fast DDS that send again (docs/decisions/0014), discover and keep timers
// (0015) below the cycles.
#include <dlfcn.h>

#include <cstring>
#include <memory>
#include <system_error>
#include <thread>
#include <tuple>
#include <typeinfo>
#include <utility>

#include "components/topics/node/filtered_transport.h"
#include "components/topics/node/helper_thread.h"

namespace eprosima::fastdds::rtps {
class UDPChannelResource;  // not in its public headers
}

namespace sinew::node::internal {
namespace {

// std::thread::_M_start_thread(_State_ptr, void (*)()) as the ABI of GCC and Clang writes it.
constexpr const char* kStartThread =
    "_ZNSt6thread15_M_start_threadESt10unique_ptrINS_6_StateESt14default_deleteIS1_EEPFvvE";

// The thread that retransmits. Fast DDS 2.9 starts it inside of create_participant(), with no way
// to name, find or configure it; the type of what a new thread runs names it.
bool IsRetransmission(const std::type_info& runs) noexcept {
  return std::strstr(runs.name(), "FlowControllerImpl") != nullptr;
}

// The thread of all timers of a participant.
bool KeepsTimers(const std::type_info& runs) noexcept {
  return std::strstr(runs.name(), "ResourceEvent") != nullptr;
}

}  // namespace
}  // namespace sinew::node::internal

// Every std::thread of the process is started here, Fast DDS' too: a definition in the program
// comes before libstdc++'s, which it calls.
void std::thread::_M_start_thread(_State_ptr state, void (*depend)()) {
  using Start = void (*)(std::thread*, _State_ptr, void (*)());
  static const auto kStart =
      reinterpret_cast<Start>(::dlsym(RTLD_NEXT, sinew::node::internal::kStartThread));
  if (kStart == nullptr) {
    throw std::system_error(std::make_error_code(std::errc::function_not_supported),
                            "libstdc++ without std::thread::_M_start_thread");
  }
  struct WithDuty final : _State {
    WithDuty(_State_ptr state, void (*take)()) : runs(std::move(state)), take_duty(take) {}
    void _M_run() override {
      take_duty();
      runs->_M_run();
    }
    _State_ptr runs;
    void (*take_duty)();
  };
  // State of a thread that receives from a UDP socket:
  // std::thread(&UDPChannelResource::perform_listen_operation, this, locator).
  using Channel = eprosima::fastdds::rtps::UDPChannelResource;
  using Locator = eprosima::fastrtps::rtps::Locator_t;
  using Receives = _State_impl<_Invoker<std::tuple<void (Channel::*)(Locator), Channel*, Locator>>>;

  const _State& runs = *state;
  const std::type_info& type = typeid(runs);
  if (sinew::node::internal::IsRetransmission(type)) {
    state = std::make_unique<WithDuty>(std::move(state), &sinew::node::internal::BecomeResender);
  } else if (sinew::node::internal::KeepsTimers(type)) {
    state = std::make_unique<WithDuty>(std::move(state), &sinew::node::internal::BecomeTimers);
  } else if (type == typeid(Receives)) {
    const auto& receives = static_cast<const Receives&>(runs);
    if (sinew::node::internal::IsDiscovery(std::get<2>(receives._M_func._M_t))) {
      state = std::make_unique<WithDuty>(std::move(state), &sinew::node::internal::BecomeDiscovery);
    }
  }
  kStart(this, std::move(state), depend);
}
