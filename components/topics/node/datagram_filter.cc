#include "components/topics/node/datagram_filter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace sinew::node::internal {

namespace {

constexpr std::size_t kHeader = 20;  // "RTPS", version, vendor, GUID prefix
constexpr std::size_t kSubmessageHeader = 4;

enum Submessage : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFragments = 0x12,
  kHeartbeatFragment = 0x13,
  kData = 0x15,
  kDataFragment = 0x16,
  kSecureBody = 0x30,     // DDS Security 1.1, 7.3.6: body, prefix and postfix of a submessage,
  kSecureMessage = 0x33,  // prefix of a message,
  kSecurePostfix = 0x34,  // and its postfix
};

constexpr std::uint16_t kParameterPad = 0x0000, kSentinel = 0x0001, kLease = 0x0002;

// A participant's lease in s. Fast DDS 2.9 takes a missing one for 0, and goes on with what it has
// just stored of a participant without its lock (PDPListener::onNewCacheChangeAdded) while the
// thread of timers may already clear it: it then reads beyond the properties. Nobody announces
// itself more than twice a second, so a shorter lease ends between two announcements.
constexpr std::int32_t kShortestLease = 1;

enum class Form { kFixed, kLease, kText, kOctets, kTexts, kShorts, kProperties, kToken };

struct Rule {
  std::uint16_t id;
  Form form;
  std::size_t length = 0;  // of kFixed
  bool security = false;   // of use with DDS security only
};

// Parameters that our and other implementations' discovery needs. Lengths: RTPS 2.5, table 9.13.
constexpr std::array kRules = {
    Rule{kLease, Form::kLease},           // participant lease
    Rule{0x0004, Form::kFixed, 8},        // time based filter
    Rule{0x0021, Form::kFixed, 8},        // presentation
    Rule{0x0023, Form::kFixed, 8},        // deadline
    Rule{0x0027, Form::kFixed, 8},        // latency budget
    Rule{0x002b, Form::kFixed, 8},        // lifespan
    Rule{0x0040, Form::kFixed, 8},        // history
    Rule{0x0074, Form::kFixed, 8},        // type consistency
    Rule{0x0005, Form::kText},            // topic name
    Rule{0x0007, Form::kText},            // type name
    Rule{0x0062, Form::kText},            // entity name
    Rule{0x0006, Form::kFixed, 4},        // ownership strength
    Rule{0x000f, Form::kFixed, 4},        // domain id
    Rule{0x0015, Form::kFixed, 4},        // protocol version
    Rule{0x0016, Form::kFixed, 4},        // vendor
    Rule{0x001d, Form::kFixed, 4},        // durability
    Rule{0x001f, Form::kFixed, 4},        // ownership
    Rule{0x0025, Form::kFixed, 4},        // destination order
    Rule{0x0043, Form::kFixed, 4},        // expects inline QoS
    Rule{0x0053, Form::kFixed, 4},        // group entity
    Rule{0x0058, Form::kFixed, 4},        // builtin endpoints
    Rule{0x0060, Form::kFixed, 4},        // largest type
    Rule{0x0071, Form::kFixed, 4},        // status info
    Rule{0x0077, Form::kFixed, 4},        // builtin endpoint QoS
    Rule{0x8005, Form::kFixed, 4},        // disable positive acks
    Rule{0x001a, Form::kFixed, 12},       // reliability
    Rule{0x001b, Form::kFixed, 12},       // liveliness
    Rule{0x0041, Form::kFixed, 12},       // resource limits
    Rule{0x001e, Form::kFixed, 28},       // durability service
    Rule{0x0029, Form::kTexts},           // partition
    Rule{0x002c, Form::kOctets},          // user data
    Rule{0x002d, Form::kOctets},          // group data
    Rule{0x002e, Form::kOctets},          // topic data
    Rule{0x002f, Form::kFixed, 24},       // unicast locator
    Rule{0x0030, Form::kFixed, 24},       // multicast locator
    Rule{0x0031, Form::kFixed, 24},       // default unicast locator
    Rule{0x0032, Form::kFixed, 24},       // metatraffic unicast locator
    Rule{0x0033, Form::kFixed, 24},       // metatraffic multicast locator
    Rule{0x0048, Form::kFixed, 24},       // default multicast locator
    Rule{0x800f, Form::kFixed, 24},       // related sample
    Rule{0x0050, Form::kFixed, 16},       // participant GUID
    Rule{0x0052, Form::kFixed, 16},       // group GUID
    Rule{0x005a, Form::kFixed, 16},       // endpoint GUID
    Rule{0x0070, Form::kFixed, 16},       // key hash
    Rule{0x8002, Form::kFixed, 16},       // persistence GUID
    Rule{0x0059, Form::kProperties},      // properties
    Rule{0x0073, Form::kShorts},          // data representation
    Rule{0x1001, Form::kToken, 0, true},  // identity token
    Rule{0x1002, Form::kToken, 0, true},  // permissions token
    Rule{0x1006, Form::kToken, 0, true},  // identity status token
    Rule{0x1004, Form::kFixed, 8, true},  // endpoint security
    Rule{0x1005, Form::kFixed, 8, true},  // participant security
};

// Reads forward and stays within its bytes; once something was missing it reads zeros.
class Fields {
 public:
  Fields(std::span<const std::uint8_t> bytes, bool little_endian)
      : bytes_(bytes), little_endian_(little_endian) {}

  bool good() const { return good_; }
  std::size_t left() const { return bytes_.size() - at_; }

  std::span<const std::uint8_t> Take(std::size_t count) {
    if (count > left()) {
      good_ = false;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  std::uint64_t Number(std::size_t size) {
    const auto taken = Take(size);
    std::uint64_t out = 0;
    for (std::size_t k = 0; k < taken.size(); ++k) {
      out = out << 8 | taken[little_endian_ ? taken.size() - 1 - k : k];
    }
    return out;
  }
  std::uint32_t Long() { return static_cast<std::uint32_t>(Number(4)); }
  std::uint16_t Short() { return static_cast<std::uint16_t>(Number(2)); }
  // Two words, the upper one first in either byte order; it begins at 1.
  std::int64_t SequenceNumber() {
    const std::uint64_t high = Number(4);
    return static_cast<std::int64_t>(high << 32 | Number(4));
  }
  // To the next multiple of four, as far as there is one.
  void Align() { at_ = std::min(bytes_.size(), (at_ + 3) / 4 * 4); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool little_endian_;
  std::size_t at_ = 0;
  bool good_ = true;
};

// The length counts the zero at the end, which has to be there.
bool IsText(Fields* fields) {
  const auto text = fields->Take(fields->Long());
  fields->Align();
  return fields->good() && (text.empty() || text.back() == 0);
}

bool IsOctets(Fields* fields) {
  fields->Take(fields->Long());
  fields->Align();
  return fields->good();
}

// As many as the number in front says, each of at least `least` bytes.
template <class Element>
bool IsSequence(Fields* fields, std::size_t least, const Element& element) {
  const std::size_t count = fields->Long();
  if (!fields->good() || count > fields->left() / least) return false;
  for (std::size_t k = 0; k < count; ++k) {
    if (!element(fields)) return false;
  }
  return true;
}

bool IsProperties(Fields* fields) {
  return IsSequence(fields, 8, [](Fields* entry) {
    const bool has_name = IsText(entry);
    return IsText(entry) && has_name;
  });
}

bool IsToken(Fields* fields) {
  return IsText(fields) && IsProperties(fields) &&
         IsSequence(fields, 8, [](Fields* entry) { return IsText(entry) && IsOctets(entry); });
}

bool Holds(const Rule& rule, std::span<const std::uint8_t> value, bool little_endian) {
  Fields fields(value, little_endian);
  switch (rule.form) {
    case Form::kFixed:
      return value.size() == rule.length;
    case Form::kLease:
      return value.size() == 8 && static_cast<std::int32_t>(fields.Long()) >= kShortestLease;
    case Form::kText:
      return IsText(&fields);
    case Form::kOctets:
      return IsOctets(&fields);
    case Form::kTexts:
      return IsSequence(&fields, 4, IsText) && fields.left() == 0;
    case Form::kShorts:
      return IsSequence(&fields, 2, [](Fields* entry) {
        entry->Short();
        return entry->good();
      });
    case Form::kProperties:
      return IsProperties(&fields);
    case Form::kToken:
      return IsToken(&fields);
  }
  return false;
}

class Checker {
 public:
  Checker(std::span<const std::uint8_t> datagram, Protection protection,
          std::vector<std::uint8_t>* copy)
      : datagram_(datagram),
        secure_(protection != Protection::kNone),
        // The library decrypts a message that begins so as a whole, or drops it.
        plain_(protection == Protection::kRequired &&
               (datagram.size() <= kHeader || datagram[kHeader] != kSecureMessage)),
        copy_(copy) {}

  std::span<const std::uint8_t> Run() {
    constexpr std::string_view kMagic = "RTPS";
    if (datagram_.size() < kHeader || datagram_[4] != 2 ||
        !std::equal(kMagic.begin(), kMagic.end(), datagram_.begin())) {
      return {};
    }
    std::size_t at = kHeader, end = kHeader;  // end: of the last submessage that goes on
    bool says_something = false;
    while (at < datagram_.size()) {
      if (datagram_.size() - at < kSubmessageHeader) return {};
      const std::uint8_t id = datagram_[at];
      const bool little_endian = (datagram_[at + 1] & 1) != 0;
      std::size_t length = Fields(datagram_.subspan(at + 2, 2), little_endian).Short();
      const std::size_t body = at + kSubmessageHeader;
      // Without a length is the last one, which goes on to the end.
      if (length == 0 && id != kPad && id != kInfoTimestamp) length = datagram_.size() - body;
      if (length > datagram_.size() - body) return {};
      const std::size_t next = std::min(datagram_.size(), body + (length + 3) / 4 * 4);
      if (!Wanted(id) || (plain_ && !MayBePlain(id, body, length))) {
        removed_.push_back(at);
      } else {
        if (!WellFormed(id, datagram_[at + 1], body, length)) return {};
        end = next;
        says_something = says_something || !IsAboutOthers(id);
      }
      at = next;
    }
    // Nothing is left, or, of what ought to be encrypted, nothing but what stood in front of it.
    if (end == kHeader || (plain_ && !says_something)) return {};
    return Edited(end);
  }

 private:
  bool Wanted(std::uint8_t id) const {
    switch (id) {
      case kPad:
      case kAckNack:
      case kHeartbeat:
      case kGap:
      case kInfoTimestamp:
      case kInfoSource:
      case kInfoDestination:
      case kNackFragments:
      case kHeartbeatFragment:
      case kData:
      case kDataFragment:
        return true;
      default:
        return secure_ && id >= kSecureBody && id <= kSecurePostfix;
    }
  }

  // True for a submessage that only says something about those that follow.
  static bool IsAboutOthers(std::uint8_t id) {
    return id == kPad || id == kInfoTimestamp || id == kInfoDestination || id == kInfoSource;
  }

  // In a message that is not encrypted, where all are: what is said before there are keys, and what
  // is encrypted itself.
  bool MayBePlain(std::uint8_t id, std::size_t at, std::size_t length) const {
    switch (id) {
      case kData:
      case kDataFragment: {
        constexpr std::size_t kToWriter = 8, kWriter = 4;
        if (length < kToWriter + kWriter) return false;
        const std::uint32_t writer =
            Fields(datagram_.subspan(at + kToWriter, kWriter), false).Long();
        return writer == kDiscoveryOfParticipants || writer == kHandshakes;
      }
      case kInfoSource:  // that all comes from somebody else
        return false;
      default:
        return IsAboutOthers(id) || (id >= kSecureBody && id <= kSecurePostfix);
    }
  }

  bool WellFormed(std::uint8_t id, std::uint8_t flags, std::size_t at, std::size_t length) {
    Fields fields(datagram_.subspan(at, length), (flags & 1) != 0);
    switch (id) {
      case kAckNack:
        return IsAddressed(&fields) && IsSet(&fields, 8) && Counted(&fields);
      case kNackFragments:
        return IsAddressed(&fields) && fields.SequenceNumber() > 0 && IsSet(&fields, 4) &&
               Counted(&fields);
      case kHeartbeat: {
        if (!IsAddressed(&fields)) return false;
        const std::int64_t first = fields.SequenceNumber(), last = fields.SequenceNumber();
        return first > 0 && last >= first - 1 && Counted(&fields);
      }
      case kHeartbeatFragment:
        return IsAddressed(&fields) && fields.SequenceNumber() > 0 && fields.Long() > 0 &&
               Counted(&fields);
      case kGap: {
        // The reader goes through them one by one: some millions take it some tenths of a second.
        constexpr std::int64_t kLongestGap = 1 << 26;
        if (!IsAddressed(&fields)) return false;
        const std::int64_t first = fields.SequenceNumber();
        const std::int64_t base = Fields(fields).SequenceNumber();
        return first > 0 && base >= 0 && base - first <= kLongestGap && IsSet(&fields, 8);
      }
      case kInfoTimestamp:
        return (flags & 2) != 0 || length >= 8;
      case kInfoSource:
        return length == 20;
      case kInfoDestination:
        return length >= 12;
      case kData:
        return IsData(flags, at, length);
      case kDataFragment:
        return IsFragments(flags, at, length);
      default:
        return true;
    }
  }

  // Reader and writer; a writer has an identifier, a reader may be every one.
  static bool IsAddressed(Fields* fields) {
    fields->Long();
    return fields->Long() != 0;
  }
  static bool Counted(Fields* fields) {
    fields->Long();
    return fields->good();
  }
  // A set of numbers of this size: the first, the number of bits, the bits.
  static bool IsSet(Fields* fields, std::size_t size) {
    if (size == 8) {
      if (fields->SequenceNumber() < 0) return false;
    } else {
      fields->Number(size);
    }
    const std::uint32_t bits = fields->Long();
    if (bits > 256) return false;
    fields->Take((bits + 31) / 32 * 4);
    return fields->good();
  }

  static constexpr std::uint32_t kDiscoveryOfParticipants = 0x000100c2;
  static constexpr std::uint32_t kParticipantMessages = 0x000200c2, kHandshakes = 0x000201c3;
  static constexpr std::uint32_t kDiscoveryOfWriters = 0x000003c2, kDiscoveryOfReaders = 0x000004c2;

  // The head of DATA and DATA_FRAG: where the list of parameters, if any, or the payload begins, as
  // a distance from `at`. extra: bytes between the sequence number and that.
  struct Head {
    std::uint32_t writer = 0;
    std::size_t payload = 0;
  };
  std::optional<Head> HeadOf(std::uint8_t flags, std::size_t at, std::size_t length,
                             std::size_t extra) {
    const bool little_endian = (flags & 1) != 0;
    const auto bytes = datagram_.subspan(at, length);
    Fields fields(bytes, little_endian);
    fields.Short();
    const std::size_t to_parameters = 4 + fields.Short();
    fields.Long();
    const auto writer = fields.Take(4);
    const std::int64_t number = fields.SequenceNumber();
    if (!fields.good() || number <= 0 || to_parameters < 20 + extra || to_parameters > length ||
        to_parameters % 4 != 0) {
      return std::nullopt;
    }
    Head head;
    head.writer = static_cast<std::uint32_t>(Fields(writer, false).Long());
    head.payload = to_parameters;
    if (head.writer == 0) return std::nullopt;
    if ((flags & 2) != 0) {
      const auto size = ParametersOf(at + to_parameters, length - to_parameters, little_endian);
      if (!size) return std::nullopt;
      head.payload += *size;
    }
    return head;
  }

  bool IsData(std::uint8_t flags, std::size_t at, std::size_t length) {
    const std::optional<Head> head = HeadOf(flags, at, length, 0);
    const bool data = (flags & 4) != 0, key = (flags & 8) != 0;
    if (!head || (data && key)) return false;
    const std::size_t size = length - head->payload;
    if (!data && !key) return true;
    if (size < 4) return false;
    const std::size_t payload = at + head->payload;
    switch (head->writer) {
      case kDiscoveryOfParticipants:
      case kDiscoveryOfWriters:
      case kDiscoveryOfReaders: {
        // Encapsulation PL_CDR_BE or PL_CDR_LE, then a list of parameters.
        const std::uint8_t encapsulation = datagram_[payload + 1];
        if (datagram_[payload] != 0 || (encapsulation != 2 && encapsulation != 3)) return false;
        has_lease_ = false;
        return ParametersOf(payload + 4, size - 4, encapsulation == 3).has_value() &&
               (key || has_lease_ || head->writer != kDiscoveryOfParticipants);
      }
      case kParticipantMessages:  // encapsulation, GUID prefix, kind, octets
        if (size < 24) return false;
        return Fields(datagram_.subspan(payload + 20, size - 20), datagram_[payload + 1] % 2 != 0)
                   .Long() <= size - 24;
      case kHandshakes: {
        // DDS Security 1.1, 7.4.3: two identities of a message, three GUIDs, class, tokens.
        Fields message(datagram_.subspan(payload + 4, size - 4), datagram_[payload + 1] % 2 != 0);
        message.Take(2 * 24 + 3 * 16);
        return IsText(&message) && IsSequence(&message, 12, IsToken);
      }
      default:
        return true;
    }
  }

  bool IsFragments(std::uint8_t flags, std::size_t at, std::size_t length) {
    // Discovery of a robot fits a datagram: nobody sends it in fragments.
    constexpr std::uint32_t kBuiltin = 0xc0;
    constexpr std::uint64_t kLargestSample = 64u << 20;
    const std::optional<Head> head = HeadOf(flags, at, length, 12);
    if (!head || (!secure_ && (head->writer & kBuiltin) == kBuiltin)) return false;
    Fields fields(datagram_.subspan(at + 20, 12), (flags & 1) != 0);
    const std::uint64_t first = fields.Long(), count = fields.Short(), size = fields.Short();
    const std::uint64_t sample = fields.Long();
    if (first == 0 || count == 0 || size == 0 || sample == 0 || sample > kLargestSample) {
      return false;
    }
    const std::uint64_t begin = (first - 1) * size;
    if (begin >= sample || first - 1 + count > (sample + size - 1) / size) return false;
    return length - head->payload >= std::min(count * size, sample - begin);
  }

  // Its size with the sentinel. Parameters that nobody here needs are noted as removed.
  std::optional<std::size_t> ParametersOf(std::size_t at, std::size_t size, bool little_endian) {
    std::size_t done = 0;
    while (size - done >= 4) {
      Fields head(datagram_.subspan(at + done, 4), little_endian);
      const std::uint16_t id = head.Short();
      const std::size_t length = head.Short();
      if (id == kSentinel) return done + 4;
      has_lease_ = has_lease_ || id == kLease;
      if (length % 4 != 0 || length > size - done - 4) return std::nullopt;
      const auto rule = std::find_if(kRules.begin(), kRules.end(),
                                     [&](const Rule& each) { return each.id == id; });
      if (rule == kRules.end() || (rule->security && !secure_)) {
        if (id != kParameterPad) blanked_.push_back(at + done);
      } else if (!Holds(*rule, datagram_.subspan(at + done + 4, length), little_endian)) {
        return std::nullopt;
      }
      done += 4 + length;
    }
    return std::nullopt;
  }

  // Cuts off what was removed behind `end`; before it a copy has padding in its place.
  std::span<const std::uint8_t> Edited(std::size_t end) {
    std::erase_if(removed_, [&](std::size_t at) { return at >= end; });
    if (removed_.empty() && blanked_.empty()) return datagram_.first(end);
    copy_->assign(datagram_.begin(), datagram_.begin() + static_cast<std::ptrdiff_t>(end));
    for (const std::size_t at : removed_) (*copy_)[at] = kPad;
    for (const std::size_t at : blanked_) (*copy_)[at] = (*copy_)[at + 1] = 0;
    return *copy_;
  }

  std::span<const std::uint8_t> datagram_;
  bool secure_;
  bool plain_;              // not encrypted, where it ought to be
  bool has_lease_ = false;  // of the list of parameters that was read last
  std::vector<std::uint8_t>* copy_;
  std::vector<std::size_t> removed_;  // where submessages begin
  std::vector<std::size_t> blanked_;  // where parameters begin
};

}  // namespace

std::span<const std::uint8_t> DatagramFilter::Pass(std::span<const std::uint8_t> datagram,
                                                   std::vector<std::uint8_t>* copy) const {
  return Checker(datagram, protection_, copy).Run();
}

}  // namespace sinew::node::internal
