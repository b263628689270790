#include "tactus/record/contact_figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace tactus {
namespace {

constexpr double kPeriod_s = 0.001;

/// Of one contact of module 1 from 1 s to 5 s, in which the force is that function of time.
ContactFigures figuresOf(const std::function<double(double)>& force,
                         const std::function<void(CycleRecord&)>& change = {}) {
  ContactFiguresList list({{.start_s = 1.0, .end_s = 5.0, .peak_force_N = 0.0, .module = 1}});
  for (int i = 0; i < 6000; ++i) {
    CycleRecord record;
    record.t_s = kPeriod_s * i;
    record.force_sensor_N[0] = 100.0;
    record.force_sensor_N[1] = force(record.t_s);
    record.contact_position_m[1] = 1e-3 * i;
    if (change) change(record);
    list.add(record);
  }
  return list.figures().front();
}

TEST(ContactFigures, OfAForceThatRests) {
  const ContactFigures figures =
      figuresOf([](double t_s) { return t_s < 2.0 ? 7.0 - std::abs(t_s - 1.5) : 4.0; });
  EXPECT_NEAR(figures.position_m, 1.5, 1e-9);
  EXPECT_NEAR(figures.rest_force_N, 4.0, 1e-12);
  EXPECT_EQ(figures.swing_hz, 0.0);
  EXPECT_NEAR(figures.time_above_s, 1.0, 2e-3);  // F_act + F_th is 5 N
}

TEST(ContactFigures, OfOneThatSwings) {
  const ContactFigures figures = figuresOf(
      [](double t_s) { return 4.0 + 0.5 * std::sin(2.0 * std::numbers::pi * 7.0 * t_s); });
  EXPECT_NEAR(figures.swing_N, 1.0, 1e-3);
  EXPECT_NEAR(figures.swing_hz, 7.0, 0.5);
}

TEST(ContactFigures, OfLawAndTool) {
  const ContactFigures figures = figuresOf([](double) { return 4.0; },
                                           [](CycleRecord& record) {
                                             record.u_n = record.t_s < 4.0 ? 0.1 : 0.0;
                                             record.u_t = record.t_s < 2.0 ? 0.1 : 0.0;
                                             record.tool_error_m[1] = record.t_s < 1.0 ? 1.0 : 0.02;
                                             record.stiffness_N_per_m = 1e3 * record.t_s;
                                             record.gains.force.damping =
                                                 record.t_s < 3.0 ? 0.5 : 0.9;
                                           });
  EXPECT_NEAR(figures.null_share, 2.0 / 3.0, 1e-3);
  EXPECT_EQ(figures.tcp_error_max_m, 0.02);
  EXPECT_NEAR(figures.stiffness_N_per_m, 5e3, 1e-6);
  EXPECT_EQ(figures.gains.force.damping, 0.5);
}

/// Of a touch of a cycle or two there is hardly anything to say.
TEST(ContactFigures, OfAShortTouchAreFinite) {
  ContactFiguresList list({{.start_s = 0.001, .end_s = 0.002}});
  for (int i = 0; i < 5; ++i) {
    CycleRecord record;
    record.t_s = kPeriod_s * i;
    list.add(record);
  }
  const ContactFigures figures = list.figures().front();
  EXPECT_TRUE(std::isfinite(figures.rest_force_N) && std::isfinite(figures.swing_hz));
  EXPECT_EQ(figures.null_share, 0.0);
}

}  // namespace
}  // namespace tactus
