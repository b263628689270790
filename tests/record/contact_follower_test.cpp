#include "tactus/record/contact_follower.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "support/rail_robot.h"
#include "tactus/record/contact_json.h"

namespace tactus {
namespace {

constexpr double kFollowedCycle_s = 0.001;
constexpr double kFollowed_N = 4.0;  ///< before the contact nothing, then this or what is asked for

ControllerConfig twoModules() {
  ControllerConfig config = test::railController(Variant::kNullSpace);
  config.tactile_modules.push_back(config.tactile_modules.front());
  return config;
}

/// Of one contact of module 1 from 1 s to 5 s, in which the force is that function of time.
ContactFigures followed(const std::function<double(double)>& force,
                        const std::function<void(CycleRecord&)>& change = {}) {
  ContactFollower follower(twoModules(), 0, 1);
  std::vector<ContactFigures> over;
  for (int i = 0; i < 6000; ++i) {
    CycleRecord record;
    record.t_s = kFollowedCycle_s * i;
    record.force_sensor_N[0] = 100.0;
    record.force_sensor_N[1] = i >= 1000 && i < 5000 ? force(record.t_s) : 0.0;
    record.contact_position_m[1] = 1e-3 * i;
    if (change) change(record);
    if (std::optional<ContactFigures> figures = follower.add(record)) over.push_back(*figures);
  }
  EXPECT_EQ(over.size(), 1u);
  EXPECT_FALSE(follower.present());
  return over.front();
}

TEST(ContactFollower, OfAForceThatRests) {
  const ContactFigures figures =
      followed([](double t_s) { return t_s < 2.0 ? 7.0 - std::abs(t_s - 1.5) : kFollowed_N; });
  EXPECT_NEAR(figures.start_s, 1.0, 1e-9);
  EXPECT_NEAR(figures.end_s, 5.0, 1e-9);
  EXPECT_NEAR(figures.peak_force_N, 7.0, 1e-9);
  EXPECT_NEAR(figures.position_m, 1.5, 1e-9);
  EXPECT_NEAR(figures.rest_force_N, kFollowed_N, 1e-12);
  EXPECT_EQ(figures.swing_hz, 0.0);
  EXPECT_NEAR(figures.time_above_s, 1.0, 2e-3);  // F_act + F_th is 3.8 N
}

/// Behind the release, but within the 0.1 s that tell it.
TEST(ContactFollower, OfALastBounceHasForceAndPlace) {
  const ContactFigures figures = followed([](double t_s) {
    const bool is_bounce = t_s > 4.0495 && t_s < 4.0525;
    return is_bounce ? 9.0 : t_s < 4.0 ? kFollowed_N : 0.0;
  });
  EXPECT_NEAR(figures.end_s, 4.0, 1e-9);
  EXPECT_NEAR(figures.peak_force_N, 9.0, 1e-9);
  EXPECT_NEAR(figures.position_m, 4.05, 1e-9);
}

TEST(ContactFollower, OfOneThatSwings) {
  const ContactFigures figures = followed(
      [](double t_s) { return kFollowed_N + 0.5 * std::sin(2.0 * std::numbers::pi * 7.0 * t_s); });
  EXPECT_NEAR(figures.swing_N, 1.0, 1e-3);
  EXPECT_NEAR(figures.swing_hz, 7.0, 0.5);
}

TEST(ContactFollower, OfLawAndTool) {
  const ContactFigures figures = followed([](double) { return kFollowed_N; },
                                          [](CycleRecord& record) {
                                            record.force_sensor_N[0] = 1.0;
                                            record.k_n = 0.5;
                                            record.k_t = 0.25;
                                            record.u_n = record.t_s < 4.0 ? -0.1 : 0.0;
                                            record.u_t = record.t_s < 2.0 ? -0.1 : 0.0;
                                            record.tool_error_m[1] = record.t_s < 1.0 ? 1.0 : 0.02;
                                            record.stiffness_N_per_m = 1e3 * record.t_s;
                                            record.gains.force.damping =
                                                record.t_s < 3.0 ? 0.5 : 0.9;
                                          });
  EXPECT_NEAR(figures.null_share, 2.0 / 3.0, 1e-3);
  EXPECT_NEAR(figures.task_share, 1.0 * 0.25 / (3.0 * 0.5 + 1.0 * 0.25), 1e-3);
  EXPECT_EQ(figures.tcp_error_max_m, 0.02);
  EXPECT_NEAR(figures.stiffness_N_per_m, 5e3, 2.0);  // in the last cycle, not after it
  EXPECT_EQ(figures.gains.force.damping, 0.5);
}

/// The log has c of the contact that is felt most.
TEST(ContactFollower, TakesNoStiffnessOfAnotherModule) {
  const auto stiffness_from = [](double from_s) {
    return followed([](double) { return kFollowed_N; },
                    [from_s](CycleRecord& record) {
                      record.force_sensor_N[0] = record.t_s < from_s ? 1.0 : 100.0;
                      record.stiffness_N_per_m = 1e3 * record.t_s;
                    });
  };
  EXPECT_NEAR(stiffness_from(3.0).stiffness_N_per_m, 3e3, 2.0);
  const ContactFigures figures = stiffness_from(0.0);
  EXPECT_TRUE(std::isnan(figures.stiffness_N_per_m));
  EXPECT_TRUE(contactJson(figures, {}).at("stiffness_N_per_m").is_null());
}

/// What lasts is told as if it ended now, and the same as once it is over.
TEST(ContactFollower, TellsOfAContactThatLasts) {
  ContactFollower follower(twoModules(), 0, 0);
  for (int i = 0; i < 20000; ++i) {
    CycleRecord record;
    record.t_s = kFollowedCycle_s * i;
    record.force_sensor_N[0] = i < 500 ? 0.0 : 3.0;
    record.u_n = 1.0;
    record.k_n = 1.0;
    EXPECT_FALSE(follower.add(record));
  }
  const std::optional<ContactFigures> figures = follower.present();
  ASSERT_TRUE(figures);
  EXPECT_NEAR(figures->start_s, 0.5, 1e-9);
  EXPECT_NEAR(figures->end_s, 19.999, 1e-9);
  EXPECT_NEAR(figures->rest_force_N, 3.0, 1e-12);
  EXPECT_EQ(figures->null_share, 1.0);
  EXPECT_EQ(figures->task_share, 0.0);
}

/// Of a contact of module 0 from 1 s to 5 s at 6 N, without the records of this stretch of time.
ContactFigures followedWithout(double from_s, double to_s, int missed) {
  ContactFollower follower(twoModules(), 0, 0);
  std::optional<ContactFigures> over;
  for (int i = 0; i < 6000; ++i) {
    CycleRecord record;
    record.t_s = kFollowedCycle_s * i;
    if (record.t_s >= from_s && record.t_s < to_s) continue;
    const bool is_behind = record.t_s >= to_s && record.t_s - kFollowedCycle_s < to_s;
    record.missed_cycles = is_behind ? static_cast<std::uint64_t>(missed) : 0;
    record.force_sensor_N[0] = i >= 1000 && i < 5000 ? 6.0 : 0.0;
    if (std::optional<ContactFigures> figures = follower.add(record)) over = figures;
  }
  EXPECT_TRUE(over);
  return over.value_or(ContactFigures{});
}

/// But of cycles that the loop has missed the next one says so.
TEST(ContactFollower, CountsNoTimeOfMissingRecords) {
  EXPECT_NEAR(followedWithout(0.0, 0.0, 0).time_above_s, 4.0, 2e-3);
  EXPECT_NEAR(followedWithout(2.0, 4.0, 0).time_above_s, 2.0, 3e-3);
  EXPECT_NEAR(followedWithout(2.0, 2.01, 10).time_above_s, 4.0, 2e-3);
}

/// The contact ended while nothing was recorded: not at 0 N.
TEST(ContactFollower, KnowsNoRestOfMissingRecords) {
  const ContactFigures figures = followedWithout(2.5, 5.5, 0);
  EXPECT_NEAR(figures.end_s, 5.5, 1e-9);
  EXPECT_TRUE(std::isnan(figures.rest_force_N));
  EXPECT_TRUE(std::isnan(figures.swing_N));
  EXPECT_TRUE(contactJson(figures, {}).at("rest_force_N").is_null());
}

/// A drifted sensor shows some force long before the touch.
TEST(ContactFollower, OfAnArmWithSeveralModulesBeginsAtTheThreshold) {
  const double threshold_N = CycleRecord{}.gains.force.contact_threshold_N;
  const ContactFigures figures = followed([](double) { return kFollowed_N; },
                                          [threshold_N](CycleRecord& record) {
                                            if (record.t_s < 0.9995)
                                              record.force_sensor_N[1] = 0.2 * threshold_N;
                                            record.tool_error_m[1] =
                                                record.t_s < 0.9995 ? 1.0 : 0.02;
                                          });
  EXPECT_NEAR(figures.start_s, 1.0, 1e-9);
  EXPECT_NEAR(figures.settling_s, 0.0, 1e-9);
  EXPECT_EQ(figures.tcp_error_max_m, 0.02);
}

/// As often a second of the time that is known.
TEST(ContactFollower, SwingsAsOftenWhereRecordsAreMissing) {
  ContactFollower follower(twoModules(), 0, 0);
  for (int i = 0; i < 6000; ++i) {
    CycleRecord record;
    record.t_s = kFollowedCycle_s * i;
    if (record.t_s > 5.15 && record.t_s < 5.65) continue;
    record.force_sensor_N[0] =
        i < 1000 ? 0.0 : kFollowed_N + 0.5 * std::sin(2.0 * std::numbers::pi * 20.0 * record.t_s);
    EXPECT_FALSE(follower.add(record));
  }
  const std::optional<ContactFigures> figures = follower.present();
  ASSERT_TRUE(figures);
  EXPECT_NEAR(figures->swing_hz, 20.0, 1.5);
}

/// The rows of several contacts have no k_n, k_j and k_t, which are zero in the log.
TEST(ContactFollower, DoesNotKnowTheShareOfAnAnswerWithoutGains) {
  const ContactFigures figures =
      followed([](double) { return kFollowed_N; }, [](CycleRecord& record) { record.u_t = -0.1; });
  EXPECT_TRUE(std::isnan(figures.task_share));
  EXPECT_TRUE(contactJson(figures, {}).at("task_space_share").is_null());
  const ContactFigures silent = followed([](double) { return kFollowed_N; });
  EXPECT_EQ(silent.task_share, 0.0);
}

/// Of a touch of a cycle or two there is hardly anything to say.
TEST(ContactFollower, OfAShortTouchAreFinite) {
  ContactFollower follower(test::railController(Variant::kNullSpace), 0, 0);
  int contacts = 0;
  for (int i = 0; i < 500; ++i) {
    CycleRecord record;
    record.t_s = kFollowedCycle_s * i;
    record.force_sensor_N[0] = i == 100 || i == 101 ? 3.0 : 0.0;
    record.force_contact_N = record.force_sensor_N[0];
    const std::optional<ContactFigures> figures = follower.add(record);
    if (!figures) continue;
    ++contacts;
    EXPECT_TRUE(std::isfinite(figures->rest_force_N) && std::isfinite(figures->swing_hz));
    EXPECT_EQ(figures->null_share, 0.0);
    EXPECT_FALSE(figures->touch.is_known);
  }
  EXPECT_EQ(contacts, 1);
}

}  // namespace
}  // namespace tactus
