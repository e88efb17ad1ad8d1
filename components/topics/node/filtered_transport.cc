#include "components/topics/node/filtered_transport.h"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastrtps/utils/IPLocator.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <bit>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/topics/node/datagram_filter.h"

namespace sinew::node::internal {

namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

std::atomic<std::uint64_t> datagrams_received{0}, datagrams_dropped{0};

std::string SenderText(const rtps::Locator_t& sender) {
  return rtps::IPLocator::ip_to_string(sender) + ":" +
         std::to_string(rtps::IPLocator::getPhysicalPort(sender));
}

class FilteredTransport final : public transport::ChainingTransport {
 public:
  FilteredTransport(const transport::ChainingTransportDescriptor& descriptor, bool secure)
      : transport::ChainingTransport(descriptor), filter_(secure) {}

  transport::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  bool send(rtps::SenderResource* low_sender_resource, const rtps::octet* send_buffer,
            std::uint32_t send_buffer_size, rtps::LocatorsIterator* destination_locators_begin,
            rtps::LocatorsIterator* destination_locators_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return low_sender_resource->send(send_buffer, send_buffer_size, destination_locators_begin,
                                     destination_locators_end, timeout);
  }

  void receive(transport::TransportReceiverInterface* next_receiver,
               const rtps::octet* receive_buffer, std::uint32_t receive_buffer_size,
               const rtps::Locator_t& local_locator,
               const rtps::Locator_t& remote_locator) override {
    datagrams_received.fetch_add(1, std::memory_order_relaxed);
    thread_local std::vector<std::uint8_t> copy;
    const auto passed = filter_.Pass({receive_buffer, receive_buffer_size}, &copy);
    if (passed.empty()) {
      Drop(remote_locator, receive_buffer_size);
      return;
    }
    next_receiver->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()),
                                  local_locator, remote_locator);
  }

 private:
  static void Drop(const rtps::Locator_t& sender, std::uint32_t size) {
    const std::uint64_t count = datagrams_dropped.fetch_add(1, std::memory_order_relaxed) + 1;
    // The 1st, 2nd, 4th, 8th: who sends nothing else must not fill the log.
    if (!std::has_single_bit(count)) return;
    spdlog::warn("a datagram of {} bytes from {} is no RTPS of use and was dropped ({} of {})",
                 size, SenderText(sender), count,
                 datagrams_received.load(std::memory_order_relaxed));
  }

  const DatagramFilter filter_;
};

class FilteredDescriptor final : public transport::ChainingTransportDescriptor {
 public:
  FilteredDescriptor(std::shared_ptr<transport::TransportDescriptorInterface> inner, bool secure)
      : transport::ChainingTransportDescriptor(std::move(inner)), secure_(secure) {}

  transport::TransportInterface* create_transport() const override {
    return new FilteredTransport(*this, secure_);
  }

 private:
  bool secure_;
};

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> Filtered(
    std::shared_ptr<transport::TransportDescriptorInterface> inner, bool secure) {
  return std::make_shared<FilteredDescriptor>(std::move(inner), secure);
}

DatagramCounts ReceivedDatagrams() {
  return {datagrams_received.load(std::memory_order_relaxed),
          datagrams_dropped.load(std::memory_order_relaxed)};
}

}  // namespace sinew::node::internal
