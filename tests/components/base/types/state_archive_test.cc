// The state of an object as bytes, and back.
#include "components/base/types/state_archive.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace sinew::types {
namespace {

enum class Colour { kRed, kBlue };

struct Inner {
  double value = 0.0;
  bool set = false;
  void Exchange(StateArchive& archive) { archive(value, set); }
};

struct Outer {
  double number = 0.0;
  Colour colour = Colour::kRed;
  std::array<Inner, 2> inner{};
  std::vector<double> list = std::vector<double>(3);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(2);
  std::optional<Inner> maybe = Inner{};
  int index = 0;
  void Exchange(StateArchive& archive) {
    archive(number, colour, inner, list, vector, maybe);
    archive.Bounded(index, 5);
  }
};

std::vector<std::byte> BytesOf(Outer outer) {
  StateArchive archive;
  outer.Exchange(archive);
  return archive.Release();
}

Outer Some() {
  Outer outer;
  outer.number = std::nextafter(0.1, 1.0);
  outer.colour = Colour::kBlue;
  outer.inner[1] = {-0.0, true};
  outer.list = {1.0, std::numeric_limits<double>::infinity(), 3.0};
  outer.vector << 4.0, 5.0;
  outer.maybe->value = 6.0;
  outer.index = 5;
  return outer;
}

std::string ErrorOf(Outer outer, const std::vector<std::byte>& bytes) {
  try {
    StateArchive archive(bytes);
    outer.Exchange(archive);
    archive.Finish();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(StateArchive, ComesBackToTheSameBits) {
  const std::vector<std::byte> bytes = BytesOf(Some());
  Outer read;
  StateArchive archive(bytes);
  read.Exchange(archive);
  archive.Finish();
  EXPECT_EQ(BytesOf(read), bytes);
  EXPECT_EQ(read.number, std::nextafter(0.1, 1.0));
  EXPECT_TRUE(std::signbit(read.inner[1].value));
  EXPECT_EQ(read.colour, Colour::kBlue);
  EXPECT_EQ(read.index, 5);
}

TEST(StateArchive, EveryTruncatedLengthIsRefused) {
  const std::vector<std::byte> bytes = BytesOf(Some());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_NE(ErrorOf({}, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}),
              "no error")
        << size;
  }
}

TEST(StateArchive, AnotherConfigurationIsRefused) {
  std::vector<std::byte> longer = BytesOf(Some());
  longer.push_back(std::byte{0});
  EXPECT_EQ(ErrorOf({}, longer), "state: 1 bytes are left, expected none: another configuration");
  Outer other;
  other.list.resize(4);
  EXPECT_EQ(ErrorOf(other, BytesOf(Some())),
            "state: a list of 3, expected 4: another configuration");
  Outer without;
  without.maybe.reset();
  EXPECT_EQ(ErrorOf(without, BytesOf(Some())),
            "state: a list of 1, expected 0: another configuration");
}

TEST(StateArchive, AnIndexBeyondItsBoundIsRefused) {
  Outer outer = Some();
  outer.index = 6;
  EXPECT_EQ(ErrorOf({}, BytesOf(outer)), "state: an index is 6, expected 0 to 5");
  outer.index = -1;
  EXPECT_EQ(ErrorOf({}, BytesOf(outer)), "state: an index is -1, expected 0 to 5");
}

}  // namespace
}  // namespace sinew::types
