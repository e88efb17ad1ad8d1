#include "components/topics/node/codec.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "components/base/types/fnv1a.h"
#include "components/topics/node/all_messages.h"

namespace sinew::node {

namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

// A field of the visitors below is a number, an enumeration (as 32 bits), a text, an array or
// sequence of numbers or enumerations, or a message (idl/, the subset that tests/idl checks).

// Writes the fields that it visits; a text is cut at its bound. Throws length_error: a sequence is
// longer than its bound.
class Writing {
 public:
  explicit Writing(Cdr* cdr) : cdr_(*cdr) {}

  template <class T>
  void operator()(std::string_view name, const T& value, std::size_t most) {
    Put(name, value, most);
  }

 private:
  void Put(std::string_view, const std::string& text, std::size_t most) {
    if (text.size() > most) {
      cdr_ << text.substr(0, most).c_str();
    } else {
      cdr_ << text.c_str();
    }
  }
  template <class T>
  void Put(std::string_view name, const std::vector<T>& values, std::size_t most) {
    if (values.size() > most) throw std::length_error(std::string(name));
    cdr_ << values;
  }
  template <class T, std::size_t size>
  void Put(std::string_view, const std::array<T, size>& values, std::size_t) {
    if constexpr (std::is_enum_v<T>) {
      for (const T value : values) cdr_ << static_cast<std::uint32_t>(value);
    } else {
      cdr_ << values;
    }
  }
  template <class T>
  void Put(std::string_view, const T& value, std::size_t) {
    if constexpr (std::is_enum_v<T>) {
      cdr_ << static_cast<std::uint32_t>(value);
    } else if constexpr (std::is_arithmetic_v<T>) {
      cdr_ << value;
    } else {
      T::Fields(value, *this);
    }
  }

  Cdr& cdr_;
};

// Reads the fields that it visits. Throws what Cdr throws where the bytes end; out_of_range: an
// enumerator without a name, a count, text or sequence above its bound.
class Reading {
 public:
  explicit Reading(Cdr* cdr) : cdr_(*cdr) {}

  template <class T>
  void operator()(std::string_view name, T& value, std::size_t most) {
    Take(name, &value, most);
  }

 private:
  static void Check(std::string_view name, std::size_t value, std::size_t most) {
    if (value > most) throw std::out_of_range(std::string(name));
  }
  void Take(std::string_view name, std::string* text, std::size_t most) {
    cdr_ >> *text;
    Check(name, text->size(), most);
  }
  template <class T>
  void Take(std::string_view name, std::vector<T>* values, std::size_t most) {
    std::uint32_t length = 0;
    cdr_ >> length;
    Check(name, length, most);
    values->resize(length);
    cdr_.deserializeArray(values->data(), length);
  }
  template <class T, std::size_t size>
  void Take(std::string_view name, std::array<T, size>* values, std::size_t) {
    if constexpr (std::is_enum_v<T>) {
      for (T& value : *values) Take(name, &value, 0);
    } else {
      cdr_ >> *values;
    }
  }
  template <class T>
  void Take(std::string_view name, T* value, std::size_t most) {
    if constexpr (std::is_enum_v<T>) {
      std::uint32_t number = 0;
      cdr_ >> number;
      Check(name, number, CountOf(T{}) - 1);
      *value = static_cast<T>(number);
    } else if constexpr (std::is_arithmetic_v<T>) {
      cdr_ >> *value;
      if constexpr (std::is_same_v<T, std::uint8_t>) {
        if (most > 0) Check(name, *value, most);
      }
    } else {
      T::Fields(*value, *this);
    }
  }

  Cdr& cdr_;
};

// The size of the greatest message. Texts and sequences as long as their bounds move what follows
// furthest, as aligning never brings an end forward.
class GreatestSize {
 public:
  template <class T>
  void operator()(std::string_view, const T& value, std::size_t most) {
    Add(value, most);
  }
  std::size_t size() const { return size_; }

 private:
  void AddNumbers(std::size_t count, std::size_t bytes) {
    if (count > 0) size_ = (size_ + bytes - 1) / bytes * bytes + count * bytes;
  }
  void Add(const std::string&, std::size_t most) {
    AddNumbers(1, 4);  // length, with the 0 at its end
    AddNumbers(most + 1, 1);
  }
  template <class T>
  void Add(const std::vector<T>&, std::size_t most) {
    AddNumbers(1, 4);
    AddNumbers(most, sizeof(T));
  }
  template <class T, std::size_t count>
  void Add(const std::array<T, count>&, std::size_t) {
    AddNumbers(count, sizeof(T));
  }
  template <class T>
  void Add(const T& value, std::size_t) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      AddNumbers(1, sizeof(T));
    } else {
      T::Fields(value, *this);
    }
  }

  std::size_t size_ = 0;
};

constexpr std::size_t kEncapsulation = 4;

template <class Message>
std::size_t GreatestSizeOf() {
  static const std::size_t kSize = [] {
    GreatestSize greatest;
    const Message message;
    Message::Fields(message, greatest);
    return kEncapsulation + greatest.size();
  }();
  return kSize;
}

// Cdr borrows bytes that it may write; reading, it does not.
FastBuffer Buffer(const Bytes& bytes) {
  return {const_cast<char*>(reinterpret_cast<const char*>(bytes.data())), bytes.size()};
}

// RTPS 2.3, 9.6.3.8: the key field as big-endian CDR; what may be longer than 16 bytes by its MD5.
template <class Message>
bool KeyHashOf(const Bytes& bytes, std::uint8_t hash[16]) {
  Message message;
  if (Message::kKey.empty() || !Decode(bytes, &message)) return false;
  std::fill_n(hash, 16, std::uint8_t{0});
  Message::Fields(message, [hash](std::string_view name, const auto& value, std::size_t most) {
    if (name != Message::kKey) return;
    GreatestSize greatest;
    greatest(name, value, most);
    std::vector<char> key(greatest.size());
    FastBuffer buffer(key.data(), key.size());
    Cdr cdr(buffer, Cdr::BIG_ENDIANNESS);
    Writing{&cdr}(name, value, most);
    if (key.size() <= 16) {
      std::copy_n(key.begin(), cdr.getSerializedDataLength(), hash);
      return;
    }
    MD5 digest;
    digest.update(key.data(), static_cast<unsigned int>(cdr.getSerializedDataLength()));
    digest.finalize();
    std::copy_n(digest.digest, 16, hash);
  });
  return true;
}

struct MessageType {
  std::string_view name;
  bool keyed;
  std::size_t greatest_size;
  bool (*key_hash)(const Bytes&, std::uint8_t[16]);
};

template <class Message>
MessageType TypeOf() {
  return {Message::kIdlName, !Message::kKey.empty(), GreatestSizeOf<Message>(), KeyHashOf<Message>};
}

const MessageType& FindType(std::string_view type_name) {
#define SINEW_TYPE(Type) TypeOf<msg::Type>(),
  static const std::array kTypes = {SINEW_FOR_EACH_MESSAGE(SINEW_TYPE)};
#undef SINEW_TYPE
  const auto found = std::find_if(kTypes.begin(), kTypes.end(),
                                  [&](const MessageType& type) { return type.name == type_name; });
  if (found == kTypes.end()) {
    throw std::invalid_argument("no such topic type: " + std::string(type_name));
  }
  return *found;
}

std::uint64_t Load64(const std::byte* bytes, bool little) {
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) {
    const int shift = little ? 8 * i : 8 * (7 - i);
    value |= static_cast<std::uint64_t>(bytes[i]) << shift;
  }
  return value;
}

}  // namespace

template <class Message>
bool Encode(const Message& message, Bytes* bytes) {
  bytes->resize(GreatestSizeOf<Message>());
  FastBuffer buffer = Buffer(*bytes);
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  bool fits = true;
  try {
    cdr.serialize_encapsulation();
    Message::Fields(message, Writing(&cdr));
  } catch (const std::exception&) {
    fits = false;
  }
  bytes->resize(fits ? cdr.getSerializedDataLength() : 0);
  return fits;
}

template <class Message>
bool Decode(const Bytes& bytes, Message* message) {
  FastBuffer buffer = Buffer(bytes);
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  try {
    cdr.read_encapsulation();
    Message::Fields(*message, Reading(&cdr));
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

#define SINEW_INSTANTIATE(Type)                         \
  template bool Encode(const msg::Type&, Bytes* bytes); \
  template bool Decode(const Bytes&, msg::Type*);
SINEW_FOR_EACH_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

std::uint64_t EventId(std::span<const std::byte> canonical_payload) {
  types::Fnv1a hash;
  hash.Add(canonical_payload);
  return hash.value();
}

constexpr std::size_t kOriginOffset = 4 + 8 + 8 + 8;  // encapsulation, session, tick, stamp

bool PeekHead(const std::byte* bytes, std::size_t size, HeadOfMessage* head) {
  if (size < kOriginOffset + 4) return false;
  const bool little = (bytes[1] & std::byte{1}) != std::byte{0};
  head->session_id = Load64(bytes + 4, little);
  head->tick = Load64(bytes + 12, little);
  head->origin = 0;
  for (int i = 0; i < 4; ++i) {
    const int shift = little ? 8 * i : 8 * (3 - i);
    head->origin |= static_cast<std::uint32_t>(bytes[kOriginOffset + static_cast<std::size_t>(i)])
                    << shift;
  }
  return true;
}

bool PokeOrigin(std::byte* bytes, std::size_t size, std::uint32_t origin) {
  if (size < kOriginOffset + 4) return false;
  const bool little = (bytes[1] & std::byte{1}) != std::byte{0};
  for (int i = 0; i < 4; ++i) {
    const int shift = little ? 8 * i : 8 * (3 - i);
    bytes[kOriginOffset + static_cast<std::size_t>(i)] =
        static_cast<std::byte>((origin >> shift) & 0xFF);
  }
  return true;
}

bool KeyHash(std::string_view type_name, const Bytes& bytes, std::uint8_t hash[16]) {
  return FindType(type_name).key_hash(bytes, hash);
}

std::size_t MaxEncodedSize(std::string_view type_name) { return FindType(type_name).greatest_size; }

bool IsKeyed(std::string_view type_name) { return FindType(type_name).keyed; }

}  // namespace sinew::node
