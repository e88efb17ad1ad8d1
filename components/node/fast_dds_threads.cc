// Keeps one thread of Fast DDS out of SCHED_FIFO: docs/decisions/0014.
#include <dlfcn.h>

#include <cstring>
#include <system_error>
#include <thread>
#include <typeinfo>

#include "components/node/helper_thread.h"

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
  const _State& runs = *state;
  if (!sinew::node::internal::IsRetransmission(typeid(runs))) {
    kStart(this, std::move(state), depend);
    return;
  }
  const sinew::node::internal::HelpersBegin out_of_fifo("dds-resend");
  kStart(this, std::move(state), depend);
}
