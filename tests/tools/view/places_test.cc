// Places: who is closed when there are more than there may be.
#include "tools/view/places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace sinew::live {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// What takes places, and the numbers of those that were closed.
struct Guests {
  explicit Guests(std::size_t most) : places(most) {}
  void Enter(const std::string& owner, std::size_t weight = 1) {
    const std::size_t number = held.size();
    held.push_back(std::make_unique<Place>(&places, owner, weight,
                                           [this, number] { closed.push_back(number); }));
  }
  Places places;
  std::vector<std::size_t> closed;
  std::vector<std::unique_ptr<Place>> held;
};

TEST(Places, ANewerOneClosesTheOldestWhenAllAreTaken) {
  Guests guests(3);
  for (int i = 0; i < 5; ++i) guests.Enter("a");
  EXPECT_THAT(guests.closed, ElementsAre(0, 1));
  EXPECT_EQ(guests.places.taken(), 3u);
}

TEST(Places, TheManyOfOneOwnerCloseEachOtherOnly) {
  Guests guests(4);
  guests.Enter("few");
  for (int i = 0; i < 100; ++i) guests.Enter("many");
  EXPECT_EQ(guests.closed.size(), 97u);
  EXPECT_EQ(guests.closed.front(), 1u);
  guests.Enter("few");
  guests.Enter("few");  // it has as many as the other one now, and is the one that wants more
  EXPECT_EQ(guests.closed.back(), 0u);
}

TEST(Places, OneThatLeavesFreesItsPlaceOnceAndIsNotClosed) {
  Guests guests(2);
  for (int i = 0; i < 3; ++i) guests.Enter("a");
  guests.held[0].reset();  // was closed
  guests.held[1].reset();
  EXPECT_EQ(guests.places.taken(), 1u);
  guests.Enter("a");
  EXPECT_THAT(guests.closed, ElementsAre(0));
}

TEST(Places, WeightsCountAndTheHeaviestIsThereAlone) {
  Guests guests(100);
  guests.Enter("a", 60);
  guests.Enter("b", 40);
  EXPECT_THAT(guests.closed, IsEmpty());
  guests.Enter("b", 10);
  EXPECT_THAT(guests.closed, ElementsAre(0)) << "a has most";
  guests.Enter("c", 1000);
  EXPECT_THAT(guests.closed, ElementsAre(0, 1, 2));
  EXPECT_EQ(guests.places.taken(), 1000u);
  guests.Enter("c", 0);
  EXPECT_EQ(guests.places.taken(), 0u);
}

}  // namespace
}  // namespace sinew::live
