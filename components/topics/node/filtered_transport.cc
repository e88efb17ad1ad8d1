#include "components/topics/node/filtered_transport.h"

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastrtps/utils/IPLocator.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <bit>
#include <fastdds/rtps/common/LocatorList.hpp>
#include <mutex>
#include <span>
#include <string>
#include <utility>

namespace sinew::node::internal {

namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

std::atomic<std::uint64_t> datagrams_received{0}, datagrams_dropped{0};

std::string SenderText(const rtps::Locator_t& sender) {
  return rtps::IPLocator::ip_to_string(sender) + ":" +
         std::to_string(rtps::IPLocator::getPhysicalPort(sender));
}

class FilteredDescriptor final : public transport::ChainingTransportDescriptor {
 public:
  FilteredDescriptor(std::shared_ptr<transport::TransportDescriptorInterface> inner,
                     Admission admission)
      : transport::ChainingTransportDescriptor(std::move(inner)),
        admission_(std::move(admission)) {}

  transport::TransportInterface* create_transport() const override;
  // The tag has its place in the datagram of the transport below.
  std::uint32_t max_message_size() const override {
    const std::uint32_t below = low_level_descriptor->max_message_size();
    return admission_.key ? below - DatagramKey::kTagBytes : below;
  }
  const Admission& admission() const { return admission_; }

 private:
  Admission admission_;
};

class FilteredTransport final : public transport::ChainingTransport {
 public:
  explicit FilteredTransport(const FilteredDescriptor& descriptor)
      : transport::ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* low_sender_resource, const rtps::octet* send_buffer,
            std::uint32_t send_buffer_size, rtps::LocatorsIterator* destination_locators_begin,
            rtps::LocatorsIterator* destination_locators_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    thread_local std::vector<std::uint8_t> tagged;
    if (admission_.key) {
      admission_.key->AddTag({send_buffer, send_buffer_size}, &tagged);
      send_buffer = tagged.data();
      send_buffer_size = static_cast<std::uint32_t>(tagged.size());
    }
    if (admission_.copies == 1) {
      return low_sender_resource->send(send_buffer, send_buffer_size, destination_locators_begin,
                                       destination_locators_end, timeout);
    }
    // The iterators are used up by one pass.
    thread_local transport::LocatorList all, far;
    all.clear();
    far.clear();
    for (; *destination_locators_begin != *destination_locators_end;
         ++*destination_locators_begin) {
      const rtps::Locator_t& to = **destination_locators_begin;
      all.push_back(to);
      if (!rtps::IPLocator::isLocal(to)) far.push_back(to);
    }
    const auto send_to = [&](const transport::LocatorList& locators) {
      transport::Locators begin(locators.begin()), end(locators.end());
      return low_sender_resource->send(send_buffer, send_buffer_size, &begin, &end, timeout);
    };
    const bool sent = send_to(all);
    for (int copy = 1; copy < admission_.copies && !far.empty(); ++copy) {
      (void)send_to(far);
    }
    return sent;
  }

  void receive(transport::TransportReceiverInterface* next_receiver,
               const rtps::octet* receive_buffer, std::uint32_t receive_buffer_size,
               const rtps::Locator_t& local_locator,
               const rtps::Locator_t& remote_locator) override {
    datagrams_received.fetch_add(1, std::memory_order_relaxed);
    thread_local std::vector<std::uint8_t> copy;
    const char* why = admission_.protection == Protection::kRequired
                          ? "is no RTPS of use, or not protected by DDS security"
                          : "is no RTPS of use";
    const auto admitted = Admitted({receive_buffer, receive_buffer_size}, remote_locator, &why);
    const auto passed = filter_.Pass(admitted, &copy);
    if (passed.empty()) {
      Drop(remote_locator, receive_buffer_size, why);
      return;
    }
    std::unique_lock<std::mutex> in_turn(discovery_, std::defer_lock);
    if (IsDiscovery(local_locator)) in_turn.lock();
    next_receiver->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()),
                                  local_locator, remote_locator);
  }

 private:
  // The part of it that may be read. Empty: nothing, and why.
  std::span<const std::uint8_t> Admitted(std::span<const std::uint8_t> datagram,
                                         const rtps::Locator_t& sender, const char** why) const {
    if (!admission_.key) {
      if (admission_.protection != Protection::kNone || !DatagramKey::HasTag(datagram))
        return datagram;
      *why = "has an authentication tag, and this process has no key (--key, SINEW_KEY)";
      return {};
    }
    const auto verified = admission_.key->Verified(datagram);
    if (!verified.empty()) return verified;
    const std::uint32_t address = NumberOf(rtps::IPLocator::ip_to_string(sender));
    for (const InterfaceAddress& interface : admission_.open) {
      if (IsOfNetwork(interface, address)) return datagram;
    }
    *why = "has no authentication tag of this deployment's key (--key, SINEW_KEY)";
    return {};
  }

  static void Drop(const rtps::Locator_t& sender, std::uint32_t size, const char* why) {
    const std::uint64_t count = datagrams_dropped.fetch_add(1, std::memory_order_relaxed) + 1;
    // The 1st, 2nd, 4th, 8th: a sender of nothing else must not fill the log.
    if (!std::has_single_bit(count)) return;
    spdlog::warn("a datagram of {} bytes from {} {} and was dropped ({} of {})", size,
                 SenderText(sender), why, count,
                 datagrams_received.load(std::memory_order_relaxed));
  }

  FilteredDescriptor descriptor_;
  const Admission& admission_ = descriptor_.admission();
  const DatagramFilter filter_{admission_.protection};
  std::mutex discovery_;  // held while one of its datagrams is read
};

transport::TransportInterface* FilteredDescriptor::create_transport() const {
  return new FilteredTransport(*this);
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> Filtered(
    std::shared_ptr<transport::TransportDescriptorInterface> inner, Admission admission) {
  return std::make_shared<FilteredDescriptor>(std::move(inner), std::move(admission));
}

DatagramCounts ReceivedDatagrams() {
  return {datagrams_received.load(std::memory_order_relaxed),
          datagrams_dropped.load(std::memory_order_relaxed)};
}

}  // namespace sinew::node::internal
