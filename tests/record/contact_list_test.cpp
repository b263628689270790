#include "tactus/record/contact_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace tactus {
namespace {

constexpr double kThreshold_N = 1.2;  // the defaults
constexpr double kRelease_N = 0.3;

/// All of a run, cycle by cycle.
class ContactCollection {
 public:
  explicit ContactCollection(ContactList list) : list_(std::move(list)) {}
  void add(const CycleRecord& record) {
    if (const std::optional<ContactSummary> over = list_.add(record)) over_.push_back(*over);
  }
  std::vector<ContactSummary> contacts() const {
    std::vector<ContactSummary> contacts = over_;
    if (const std::optional<ContactSummary> present = list_.present()) contacts.push_back(*present);
    return contacts;
  }

 private:
  ContactList list_;
  std::vector<ContactSummary> over_;
};

/// Forces of consecutive cycles of 10 ms, starting at t = 0.
std::vector<ContactSummary> contactsOf(const std::vector<double>& forces_N, bool force_control) {
  ContactCollection list(ContactList(force_control, forces_N.size()));
  CycleRecord record;
  for (std::size_t i = 0; i < forces_N.size(); ++i) {
    record.t_s = 0.01 * static_cast<double>(i);
    record.force_sensor_N[0] = forces_N[i];
    record.force_contact_N = force_control ? std::max(0.0, forces_N[i] - kThreshold_N) : 0.0;
    list.add(record);
  }
  return list.contacts();
}

std::vector<double> sequence(const std::vector<std::pair<int, double>>& stretches) {
  std::vector<double> forces;
  for (const auto& [count, force] : stretches) forces.insert(forces.end(), count, force);
  return forces;
}

TEST(ContactList, NoTouchNoContact) {
  EXPECT_TRUE(contactsOf({}, true).empty());
  EXPECT_TRUE(contactsOf(sequence({{500, 0.0}}), true).empty());
  EXPECT_TRUE(contactsOf(sequence({{500, kThreshold_N}}), true).empty());
  EXPECT_TRUE(contactsOf(sequence({{500, 0.05}}), false).empty());
}

TEST(ContactList, StartsAboveTheThresholdAndLastsBelowItWhileTouching) {
  const auto contacts = contactsOf(sequence({{10, 0.0}, {5, 1.0}, {5, 2.0}, {30, 0.7}}), true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].start_s, 0.15);
  EXPECT_DOUBLE_EQ(contacts[0].end_s, 0.49);
  EXPECT_DOUBLE_EQ(contacts[0].peak_force_N, 2.0);
  EXPECT_NEAR(contacts[0].settling_s, 0.05, 1e-12);
}

TEST(ContactList, WithoutForceControlAContactBeginsWithItsFirstTouch) {
  const auto contacts =
      contactsOf(sequence({{10, 0.0}, {5, 0.2}, {1, 0.05}, {20, 0.06}, {5, 1.3}}), false);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].start_s, 0.16);
  EXPECT_DOUBLE_EQ(contacts[0].peak_force_N, 1.3);
  EXPECT_DOUBLE_EQ(contacts[0].end_s, 0.40);
  EXPECT_TRUE(contactsOf(sequence({{10, 0.0}, {100, kThreshold_N}}), false).empty());
}

TEST(ContactList, AShortPauseDoesNotEndAContactALongOneDoes) {
  const auto one = contactsOf(sequence({{20, 3.0}, {8, 0.0}, {22, 3.0}}), true);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_DOUBLE_EQ(one[0].end_s, 0.49);
  const auto two = contactsOf(sequence({{20, 3.0}, {11, 0.0}, {20, 4.0}}), true);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_DOUBLE_EQ(two[0].end_s, 0.20);
  EXPECT_DOUBLE_EQ(two[0].peak_force_N, 3.0);
  EXPECT_DOUBLE_EQ(two[1].start_s, 0.31);
  EXPECT_DOUBLE_EQ(two[1].peak_force_N, 4.0);
}

TEST(ContactList, SettlingIsJudgedByTheForceBeforeTheRelease) {
  // Peak 8 N, rest at 5 N, then a release that fades over 50 ms.
  const auto contacts = contactsOf(
      sequence({{10, 8.0}, {10, 5.2}, {30, 5.0}, {2, 3.0}, {2, 1.0}, {1, 0.1}, {30, 0.0}}), true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].end_s, 0.54);
  EXPECT_NEAR(contacts[0].settling_s, 0.20, 1e-12);
}

/// 1 kHz; each component of the force has Gaussian noise.
std::vector<ContactSummary> noisyContacts(const std::vector<std::pair<int, double>>& stretches,
                                          bool force_control, double noise_N, int seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_N);
  ContactCollection list(ContactList(force_control, 0));
  CycleRecord record;
  for (const double force_N : sequence(stretches)) {
    record.force_sensor_N[0] = std::hypot(force_N + noise(random), noise(random));
    record.force_contact_N = std::max(0.0, record.force_sensor_N[0] - kThreshold_N);
    list.add(record);
    record.t_s += 1e-3;
  }
  return list.contacts();
}

/// 0.1 N in each of four channels a component: most samples of a free arm exceed 0.05 N, a third
/// F_rel.
TEST(ContactList, NoiseNeitherKeepsAContactNorMakesOneNorEndsOne) {
  for (const bool force_control : {true, false}) {
    for (int seed = 0; seed < 20; ++seed) {
      const auto contacts = noisyContacts(
          {{2000, 0.0}, {1000, 5.0}, {3000, 0.7}, {3000, 0.0}, {500, 5.0}, {2000, 0.0}},
          force_control, 0.2, seed);
      ASSERT_EQ(contacts.size(), 2u) << force_control << ' ' << seed;
      EXPECT_NEAR(contacts[0].start_s, 2.0, 0.5);
      EXPECT_NEAR(contacts[0].end_s, 6.0, 0.1);
      EXPECT_NEAR(contacts[0].peak_force_N, 5.5, 0.5);
      EXPECT_NEAR(contacts[1].start_s, 9.0, 0.5);
      EXPECT_NEAR(contacts[1].end_s, 9.5, 0.1);
    }
  }
}

/// The first record behind a gap is one sample of a noisy sensor.
TEST(ContactList, DoesNotEndByOneRecordBehindAGap) {
  for (const bool force_control : {true, false}) {
    ContactCollection list(ContactList(force_control, 0));
    CycleRecord record;
    for (int i = 0; i < 4000; ++i) {
      record.t_s = 1e-3 * i;
      record.force_sensor_N[0] = i < 1000 ? 3.0 : 0.8 + (i % 2 == 0 ? 0.6 : -0.6);
      if (record.t_s > 2.0 && record.t_s < 2.2005) continue;
      list.add(record);
    }
    const std::vector<ContactSummary> contacts = list.contacts();
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_NEAR(contacts.front().end_s, 3.999, 1e-9);
  }
}

TEST(ContactList, EndsAtTheForceOfTheScene) {
  for (const auto& [release_N, count] : {std::pair{kRelease_N, 1u}, std::pair{0.75, 2u}}) {
    ContactCollection list(ContactList(true, 0));
    CycleRecord record;
    record.gains.force.transition.release_force_N = release_N;
    for (const double force_N : sequence({{20, 3.0}, {20, 0.7}, {20, 3.0}})) {
      record.force_sensor_N[0] = force_N;
      record.force_contact_N = std::max(0.0, force_N - kThreshold_N);
      list.add(record);
      record.t_s += 0.01;
    }
    EXPECT_EQ(list.contacts().size(), count) << release_N;
  }
}

/// An arm at rest between F_th and a larger F_rel touches: that is one contact.
TEST(ContactList, IsOneWhereItRestsBelowTheReleaseForce) {
  ContactCollection list(ContactList(true, 0));
  CycleRecord record;
  record.gains.force.contact_threshold_N = 0.1;
  for (const double force_N : sequence({{20, 3.0}, {200, 0.2}, {20, 0.0}})) {
    record.force_sensor_N[0] = force_N;
    record.force_contact_N = std::max(0.0, force_N - 0.1);
    list.add(record);
    record.t_s += 0.01;
  }
  EXPECT_EQ(list.contacts().size(), 1u);
}

TEST(ContactList, TheBandIsTwoPercentOrFiveHundredthsOfANewton) {
  // 10.2 N lies just within 2 % of 10 N, 10.21 N does not; at 1 N it is 0.05 N.
  EXPECT_NEAR(contactsOf(sequence({{5, 10.21}, {5, 10.199}, {5, 10.0}}), true)[0].settling_s, 0.05,
              1e-12);
  EXPECT_NEAR(contactsOf(sequence({{5, 1.3}, {5, 1.049}, {5, 1.0}}), true)[0].settling_s, 0.05,
              1e-12);
}

TEST(ContactList, AContactOfHoursKeepsItsFigures) {
  const auto contacts =
      contactsOf(sequence({{10, 0.0}, {1, 9.0}, {2'000'000, 3.0}, {3'000'001, 2.0}}), true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].start_s, 0.1);
  EXPECT_DOUBLE_EQ(contacts[0].peak_force_N, 9.0);
  EXPECT_NEAR(contacts[0].settling_s, 20000.0, 2e-6 * 50000.0);
  EXPECT_NEAR(contacts[0].end_s, 50000.11, 1e-6);
}

/// As a damaged log may have it.
TEST(ContactList, BearsATimeThatIsNone) {
  for (const double t_s : {kNoLimit, -kNoLimit, 1e17, std::nan("")}) {
    ContactCollection list(ContactList(true, 0));
    CycleRecord record;
    for (int i = 0; i < 200; ++i) {
      record.t_s = i == 50 ? t_s : 0.01 * i;
      record.force_sensor_N[0] = i < 100 ? 3.0 : 0.0;
      list.add(record);
    }
    ASSERT_FALSE(list.contacts().empty()) << t_s;
    EXPECT_EQ(list.contacts().front().peak_force_N, 3.0);
  }
}

TEST(ContactList, AContactShorterThanThePauseNeverSettles) {
  const auto contacts = contactsOf(sequence({{5, 3.0}, {30, 0.0}}), true);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_DOUBLE_EQ(contacts[0].settling_s, 0.05);
}

}  // namespace
}  // namespace tactus
