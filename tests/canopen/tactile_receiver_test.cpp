#include "tactus/canopen/tactile_receiver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "canopen/tactile_frames.h"
#include "support/allocation_guard.h"
#include "support/period.h"

namespace tactus {
namespace {

using test::Counts;
using test::kPeriod_s;
using test::tactileConfig;
using test::TactileFrames;
using test::tactileFrames;

constexpr Counts kTouch = {3000, 1000, 500, -500, -200, 0, 7, 0};

template <typename Frames>
void receive(TactileReceiver& receiver, const Frames& frames) {
  for (const CanFrame& frame : frames) receiver.receive(frame);
}

TEST(TactileReceiver, TurnsFourFramesIntoTheWrenchOfTheCalibration) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  EXPECT_EQ(receiver.sample().sequence, 0u);
  receive(receiver, tactileFrames(0, kTouch));
  const TactileSample& sample = receiver.sample();
  EXPECT_EQ(sample.sequence, 1u);
  EXPECT_NEAR(sample.force_y_N, 3.0 - 1.0 - 0.2, 1e-12);
  EXPECT_NEAR(sample.force_z_N, 0.5 + 0.5 + 0.007, 1e-12);
  EXPECT_NEAR(sample.moment_y_Nm, -0.1 * 1.0 - 0.3 * 0.007, 1e-12);
  EXPECT_NEAR(sample.moment_z_Nm, 0.1 * 2.0 - 0.3 * 0.2, 1e-12);
  EXPECT_EQ(receiver.fault(), Fault::kNone);
}

TEST(TactileReceiver, DecodesAFrameWrittenByHand) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  TactileFrames frames = tactileFrames(9, Counts{});
  // 0x123456 = 1193046 counts, and 0xFFFFFE = -2
  frames[0].data = {9, 0, 0x56, 0x34, 0x12, 0xFE, 0xFF, 0xFF};
  receive(receiver, frames);
  EXPECT_NEAR(receiver.sample().force_y_N, 1193.046 + 0.002, 1e-9);
}

TEST(TactileReceiver, DecodesEveryLevelOfEveryChannel) {
  CanTactileConfig config = tactileConfig();
  config.channels.counts_per_N = 1.0;
  std::mt19937 random(3);
  for (int channel = 0; channel < 8; ++channel) {
    config.channels.calibration.setZero();
    config.channels.calibration(2, channel) = 1.0;
    TactileReceiver receiver(config, kPeriod_s);
    for (int i = 0; i < 20000; ++i) {
      Counts counts{};
      for (std::int32_t& count : counts)
        count = static_cast<std::int32_t>(random() & 0xFFFFFF) - 0x800000;
      receive(receiver, tactileFrames(i, counts));
      ASSERT_EQ(receiver.sample().moment_y_Nm, counts[channel]);
    }
    EXPECT_EQ(receiver.counters().samples, 20000u);
  }
}

TEST(TactileReceiver, TakesTheFramesOfASampleInAnyOrder) {
  std::array<int, 4> order = {0, 1, 2, 3};
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  std::uint32_t count = 0;
  do {
    const TactileFrames frames = tactileFrames(static_cast<int>(count), kTouch);
    for (const int k : order) {
      EXPECT_EQ(receiver.sample().sequence, count) << "not before the fourth";
      receiver.receive(frames[k]);
    }
    EXPECT_EQ(receiver.sample().sequence, ++count);
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(receiver.counters().incomplete, 0u);
}

TEST(TactileReceiver, DropsASampleThatLacksAFrameAndTakesTheNext) {
  for (int missing = 0; missing < 4; ++missing) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    const TactileFrames frames = tactileFrames(5, kTouch);
    for (int k = 0; k < 4; ++k)
      if (k != missing) receiver.receive(frames[k]);
    EXPECT_EQ(receiver.sample().sequence, 0u);
    receive(receiver, tactileFrames(6, kTouch));
    EXPECT_EQ(receiver.sample().sequence, 1u);
    EXPECT_EQ(receiver.counters().incomplete, 1u);
  }
}

TEST(TactileReceiver, NeverMixesTwoSequenceNumbers) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames first = tactileFrames(1, kTouch);
  const TactileFrames second = tactileFrames(2, Counts{});
  receive(receiver, std::vector{first[0], first[1], second[2], second[3]});
  EXPECT_EQ(receiver.sample().sequence, 0u);
  receive(receiver, std::vector{second[0], second[1]});
  EXPECT_EQ(receiver.sample().sequence, 1u);
  EXPECT_EQ(receiver.sample().force_y_N, 0.0);
  EXPECT_EQ(receiver.counters().incomplete, 1u);
}

TEST(TactileReceiver, IgnoresAFrameThatComesTwice) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames frames = tactileFrames(1, kTouch);
  receive(receiver, std::vector{frames[0], frames[0], frames[1], frames[2], frames[3], frames[3]});
  EXPECT_EQ(receiver.counters().samples, 1u);
  EXPECT_EQ(receiver.counters().repeated, 2u);
  EXPECT_EQ(receiver.counters().incomplete, 0u);
}

TEST(TactileReceiver, DropsASampleOneFrameOfWhichComesInTwoVersions) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames frames = tactileFrames(1, kTouch);
  CanFrame other = frames[0];
  other.data[4] ^= 1;
  receive(receiver, std::vector{frames[0], other, frames[1], frames[2], frames[3]});
  EXPECT_EQ(receiver.sample().sequence, 0u);
  EXPECT_EQ(receiver.counters().incomplete, 1u);
  receive(receiver, frames);
  EXPECT_EQ(receiver.sample().sequence, 0u) << "its number is used up";
  receive(receiver, tactileFrames(2, kTouch));
  EXPECT_EQ(receiver.sample().sequence, 1u);
}

TEST(TactileReceiver, KnowsEachOfTheFramesThatComesTwice) {
  for (std::size_t k = 0; k < 4; ++k) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    TactileFrames frames = tactileFrames(1, kTouch);
    std::swap(frames[k], frames[0]);  // the order is free
    CanFrame other = frames[0];
    other.data[4] ^= 1;
    receive(receiver, std::vector{frames[0], other, frames[1], frames[2], frames[3]});
    EXPECT_EQ(receiver.sample().sequence, 0u) << k;
    EXPECT_EQ(receiver.counters().repeated, 1u) << k;
  }
}

/// What has the next identifier on either side, with the same number, is another's.
TEST(TactileReceiver, TakesNoFrameBesideItsFour) {
  for (const std::uint32_t id : {0x0FFu, 0x104u}) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    const TactileFrames frames = tactileFrames(1, kTouch);
    CanFrame other = frames[0];
    other.id = id;
    receive(receiver, std::vector{frames[0], other, frames[1], frames[2], other, frames[3]});
    EXPECT_EQ(receiver.sample().sequence, 1u) << id;
    EXPECT_EQ(receiver.counters().repeated, 0u) << id;
  }
}

TEST(TactileReceiver, DropsFramesOfWrongSizeOrKindButIgnoresOthersIds) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames frames = tactileFrames(1, kTouch);
  for (int size = 0; size < 256; ++size) {
    if (size == 8) continue;
    CanFrame frame = frames[0];
    frame.size = static_cast<std::uint8_t>(size);
    receiver.receive(frame);
  }
  EXPECT_EQ(receiver.counters().malformed, 255u);
  CanFrame frame = frames[0];
  frame.kind = FrameKind::kRemote;
  receiver.receive(frame);
  frame.kind = FrameKind::kError;  // CAN_ERR_RESTARTED has the number of the first id
  receiver.receive(frame);
  frame.kind = FrameKind::kData;
  frame.extended = true;
  receiver.receive(frame);
  frame.extended = false;
  frame.is_fd = true;
  receiver.receive(frame);
  EXPECT_EQ(receiver.counters().malformed, 259u);
  for (const std::uint32_t id : {0U, 0xFFU, 0x104U, 0x100U + 0x800U, 0xFFFFFFFFU}) {
    frame = frames[0];
    frame.id = id;
    receiver.receive(frame);
  }
  EXPECT_EQ(receiver.counters().malformed, 259u);
  receive(receiver, std::vector{frames[1], frames[2], frames[3]});
  EXPECT_EQ(receiver.sample().sequence, 0u) << "the first frame never came";
}

TEST(TactileReceiver, FollowsTheSequenceAroundItsEndAndOverGaps) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  int sequence = 250;
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    receive(receiver, tactileFrames(sequence % 256, kTouch));
    ASSERT_EQ(receiver.sample().sequence, i);
    sequence += 1 + static_cast<int>(i) % 127;
  }
}

TEST(TactileReceiver, AStuckOrReplayedModuleGivesNoSamples) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  for (int sequence = 0; sequence < 200; ++sequence)
    receive(receiver, tactileFrames(sequence, kTouch));
  for (int age = 0; age < 128; ++age) receive(receiver, tactileFrames(199 - age, Counts{}));
  EXPECT_EQ(receiver.sample().sequence, 200u);
  EXPECT_NEAR(receiver.sample().force_y_N, 1.8, 1e-12);
  EXPECT_EQ(receiver.counters().repeated, 4u * 128u);
}

TEST(TactileReceiver, HearsAModuleThatStartsAnewAfterAtMost129Samples) {
  for (int last = 0; last < 256; ++last) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    receive(receiver, tactileFrames(last, kTouch));
    int sequence = 0;
    for (; sequence <= 129 && receiver.sample().sequence == 1; ++sequence)
      receive(receiver, tactileFrames(sequence, kTouch));
    EXPECT_EQ(receiver.sample().sequence, 2u) << last;
    EXPECT_LE(sequence - 1, 129) << last;
  }
}

/// Cycles in which nothing comes of the module.
void waitSilently(TactileReceiver& receiver, int cycles) {
  for (int i = 0; i < cycles; ++i) receiver.tick();
}

constexpr int kCyclesPerSample = 4;
constexpr int kLongSilence = 128 * kCyclesPerSample;

TEST(TactileReceiver, TakesAnyNumberAfterALongSilence) {
  for (int next = 0; next < 256; ++next) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    receive(receiver, tactileFrames(77, kTouch));
    waitSilently(receiver, kLongSilence);
    receive(receiver, tactileFrames(next, Counts{}));
    ASSERT_EQ(receiver.sample().sequence, 2u) << next;
    EXPECT_EQ(receiver.sample().force_y_N, 0.0);
    receive(receiver, tactileFrames(next, kTouch));
    EXPECT_EQ(receiver.sample().sequence, 2u) << "and goes by its number again";
    receive(receiver, tactileFrames(next + 1, kTouch));
    EXPECT_EQ(receiver.sample().sequence, 3u);
  }
}

TEST(TactileReceiver, GoesByTheNumbersAfterAShortSilence) {
  for (int ahead = 0; ahead < 256; ++ahead) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    receive(receiver, tactileFrames(77, kTouch));
    waitSilently(receiver, 100 * kCyclesPerSample);
    receive(receiver, tactileFrames(77 + ahead, kTouch));
    EXPECT_EQ(receiver.sample().sequence, ahead >= 1 && ahead <= 127 ? 2u : 1u) << ahead;
  }
}

/// A module that counts on while nobody hears it, its clock 1 % off, the frames early or late in a
/// cycle: the first sample after any silence counts.
TEST(TactileReceiver, LosesNoSampleAfterASilenceOfAnyLength) {
  for (const double sample_cycles : {3.96, 4.0, 4.04}) {
    for (int silent = 1; silent <= 600; ++silent) {
      for (const double phase : {0.02, 0.5, 0.98}) {
        TactileReceiver receiver(tactileConfig(), kPeriod_s);
        receive(receiver, tactileFrames(200, kTouch));
        const int cycles = static_cast<int>(phase + sample_cycles * silent);
        waitSilently(receiver, cycles);
        receive(receiver, tactileFrames(200 + silent, kTouch));
        ASSERT_EQ(receiver.sample().sequence, 2u) << silent << " " << phase;
      }
    }
  }
}

TEST(TactileReceiver, AModuleThatRepeatsItselfForLongStaysIgnored) {
  for (const int number : {77, 76, 77 - 128}) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    receive(receiver, tactileFrames(77, kTouch));
    for (int i = 0; i < 1000; ++i) {
      waitSilently(receiver, kCyclesPerSample);
      receiver.receive(tactileFrames(number, Counts{})[i % 4]);
    }
    EXPECT_EQ(receiver.sample().sequence, 1u);
    waitSilently(receiver, 100 * kCyclesPerSample);
    receive(receiver, tactileFrames(number, Counts{}));
    EXPECT_EQ(receiver.sample().sequence, 1u) << "its frames have broken the silence";
  }
}

TEST(TactileReceiver, FramesThatTellNoNumberBreakNoSilence) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  receive(receiver, tactileFrames(77, kTouch));
  CanFrame cut_off = tactileFrames(78, kTouch)[0];
  cut_off.size = 7;
  CanFrame foreign = tactileFrames(78, kTouch)[0];
  foreign.id = 0x104;
  for (int i = 0; i < kLongSilence; ++i) {
    receiver.receive(i % 2 == 0 ? cut_off : foreign);
    receiver.tick();
  }
  receive(receiver, tactileFrames(77, kTouch));
  EXPECT_EQ(receiver.sample().sequence, 2u);
}

TEST(TactileReceiver, NeverMixesFramesOfBeforeAndAfterALongSilence) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames before = tactileFrames(77, kTouch);
  const TactileFrames after = tactileFrames(77, Counts{});
  receive(receiver, std::vector{before[0], before[1]});
  waitSilently(receiver, kLongSilence);
  EXPECT_EQ(receiver.counters().incomplete, 1u);
  receive(receiver, std::vector{after[2], after[3]});
  EXPECT_EQ(receiver.sample().sequence, 0u);
  receive(receiver, std::vector{after[0], after[1]});
  EXPECT_EQ(receiver.sample().sequence, 1u);
  EXPECT_EQ(receiver.sample().force_y_N, 0.0);
  EXPECT_EQ(receiver.counters().incomplete, 1u);
}

TEST(TactileReceiver, ALateFrameOfAnOldSampleDoesNoHarm) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  const TactileFrames old = tactileFrames(1, Counts{});
  receive(receiver, old);
  const TactileFrames frames = tactileFrames(2, kTouch);
  receive(receiver, std::vector{frames[0], frames[1], old[2], frames[2], frames[3]});
  EXPECT_EQ(receiver.sample().sequence, 2u);
  EXPECT_EQ(receiver.counters().repeated, 1u);
}

/// One corrupted sequence number costs its own sample and no other.
TEST(TactileReceiver, ACorruptedSequenceNumberCostsOneSample) {
  for (int wrong = 0; wrong < 256; ++wrong) {
    if (wrong == 11) continue;
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    receive(receiver, tactileFrames(10, kTouch));
    TactileFrames frames = tactileFrames(11, kTouch);
    frames[2].data[0] = static_cast<std::uint8_t>(wrong);
    receive(receiver, frames);
    EXPECT_EQ(receiver.sample().sequence, 1u);
    receive(receiver, tactileFrames(12, kTouch));
    EXPECT_EQ(receiver.sample().sequence, 2u) << wrong;
  }
}

TEST(TactileReceiver, NamesTheFaultOfTheNewestSample) {
  const struct {
    std::uint8_t status;
    std::int32_t counts;
    Fault fault;
  } kRows[] = {
      {0x00, 0, Fault::kNone},
      {0x01, 0, Fault::kTactileSaturated},
      {0x02, 0, Fault::kTactileCableBreak},
      {0x03, 0, Fault::kTactileCableBreak},
      {0x04, 0, Fault::kTactileCableBreak},
      {0x80, 0, Fault::kTactileCableBreak},
      {0x00, 8388606, Fault::kNone},
      {0x00, -8388606, Fault::kNone},
      {0x00, 8388607, Fault::kTactileSaturated},
      {0x00, -8388607, Fault::kTactileSaturated},
      {0x00, -8388608, Fault::kTactileSaturated},
      {0x02, 8388607, Fault::kTactileCableBreak},
  };
  for (std::size_t place = 0; place < 8; ++place) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    int sequence = 0;
    for (const auto& row : kRows) {
      Counts counts{};
      counts[place] = row.counts;
      TactileFrames frames = tactileFrames(++sequence, counts);
      frames[place / 2].data[1] = row.status;  // of one frame only
      receive(receiver, frames);
      EXPECT_EQ(receiver.fault(), row.fault) << place << " " << sequence;
    }
    receive(receiver, tactileFrames(++sequence, kTouch));
    EXPECT_EQ(receiver.fault(), Fault::kNone) << "not latched";
  }
}

/// F_y alone, in newtons.
Counts forceY(double force_N) { return {static_cast<std::int32_t>(std::lround(1000 * force_N))}; }

TEST(TactileReceiver, TaresToTheMeanOfTheSamplesAtRest) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  EXPECT_EQ(receiver.tareState(), TareState::kNone);
  receiver.startTare();
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(receiver.tareState(), TareState::kAveraging);
    receive(receiver, tactileFrames(i, forceY(i % 2 == 0 ? 1.0 : 1.1)));
  }
  EXPECT_EQ(receiver.tareState(), TareState::kDone);
  receive(receiver, tactileFrames(50, forceY(3.0)));
  EXPECT_NEAR(receiver.sample().force_y_N, 1.95, 1e-9);
  EXPECT_NEAR(receiver.sample().moment_z_Nm, 0.195, 1e-9) << "moments are tared as well";
  EXPECT_EQ(receiver.tareState(), TareState::kDone);
}

/// Every sample of one tare, and what comes of it.
TareState tare(TactileReceiver& receiver, int& sequence, const std::vector<Counts>& samples) {
  receiver.startTare();
  for (const Counts& counts : samples) receive(receiver, tactileFrames(++sequence, counts));
  return receiver.tareState();
}

TEST(TactileReceiver, RefusesToTareInContactWhileUnsteadyOrFaulty) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  int sequence = 0;
  const std::vector<Counts> rest(50, forceY(0.5));
  ASSERT_EQ(tare(receiver, sequence, rest), TareState::kDone);
  EXPECT_EQ(tare(receiver, sequence, std::vector<Counts>(50, forceY(2.01))), TareState::kRefused);
  EXPECT_NEAR(receiver.tareRefusal().value, 2.01, 1e-9);
  EXPECT_EQ(receiver.tareRefusal().limit, 2.0);

  for (const std::size_t place : {std::size_t{0}, std::size_t{20}, std::size_t{49}}) {
    std::vector<Counts> touched = rest;
    touched[place] = forceY(-2.01);
    EXPECT_EQ(tare(receiver, sequence, touched), TareState::kRefused);
    touched[place] = forceY(0.71);
    EXPECT_EQ(tare(receiver, sequence, touched), TareState::kRefused);
    EXPECT_NEAR(receiver.tareRefusal().value, 0.21, 1e-9) << "spread";
    EXPECT_EQ(receiver.tareRefusal().limit, 0.2);
    EXPECT_STREQ(receiver.tareRefusal().unit, "N");
    touched[place] = {8388607, 8388107};  // F as at rest
    EXPECT_EQ(tare(receiver, sequence, touched), TareState::kRefused);
    EXPECT_STREQ(receiver.tareRefusal().unit, "") << "no force is at fault";
  }
  std::vector<Counts> turning;  // |F| stays, F does not
  for (int i = 0; i < 50; ++i) {
    turning.push_back(forceY(std::cos(0.1 * i)));
    turning.back()[2] = static_cast<std::int32_t>(std::lround(1000 * std::sin(0.1 * i)));
  }
  EXPECT_EQ(tare(receiver, sequence, turning), TareState::kRefused);

  receive(receiver, tactileFrames(++sequence, forceY(0.5)));
  EXPECT_NEAR(receiver.sample().force_y_N, 0.0, 1e-9) << "the offset before the refusals holds";
  EXPECT_EQ(tare(receiver, sequence, std::vector<Counts>(50, forceY(1.99))), TareState::kDone);
  receive(receiver, tactileFrames(++sequence, forceY(0.5)));
  EXPECT_NEAR(receiver.sample().force_y_N, -1.49, 1e-9) << "begins anew, also after a refusal";
}

/// With a row of its own, M_x is read and tared as all else; without, it is zero.
TEST(TactileReceiver, TellsTheMomentAboutTheAxisOfAModuleThatDoes) {
  CanTactileConfig config = tactileConfig();
  config.channels.moment_x = TactileChannelRow{{0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08}};
  TactileReceiver telling(config, kPeriod_s);
  TactileReceiver silent(tactileConfig(), kPeriod_s);
  int sequence = 0;
  const Counts weight = {100, 0, 0, 0, 0, 0, 0, 50};
  ASSERT_EQ(tare(telling, sequence, std::vector<Counts>(50, weight)), TareState::kDone);
  Counts touched = kTouch;
  for (std::size_t i = 0; i < touched.size(); ++i) touched[i] += weight[i];
  receive(telling, tactileFrames(++sequence, touched));
  receive(silent, tactileFrames(sequence, kTouch));
  EXPECT_NEAR(telling.sample().moment_x_Nm, 0.03 + 0.02 + 0.015 - 0.02 - 0.01 + 0.07 * 0.007,
              1e-12);
  EXPECT_NEAR(telling.sample().force_y_N, silent.sample().force_y_N, 1e-12);
  EXPECT_EQ(silent.sample().moment_x_Nm, 0.0);
}

TEST(TactileReceiver, FiltersEachComponentAtTheModulesRate) {
  CanTactileConfig config = tactileConfig();
  config.channels.moment_x = TactileChannelRow::Constant(0.03);
  TactileReceiver raw(config, kPeriod_s);
  config.filter_cutoff_hz = 15.0;
  TactileReceiver filtered(config, kPeriod_s);
  std::vector<ButterworthLowPass> filters(5, ButterworthLowPass(15.0, 250.0));
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    Counts counts{};
    for (std::int32_t& count : counts) count = static_cast<std::int32_t>(random() % 10000);
    receive(raw, tactileFrames(i, counts));
    receive(filtered, tactileFrames(i, counts));
    const TactileSample& sample = filtered.sample();
    EXPECT_EQ(sample.force_y_N, filters[0].update(raw.sample().force_y_N));
    EXPECT_EQ(sample.force_z_N, filters[1].update(raw.sample().force_z_N));
    EXPECT_EQ(sample.moment_y_Nm, filters[2].update(raw.sample().moment_y_Nm));
    EXPECT_EQ(sample.moment_z_Nm, filters[3].update(raw.sample().moment_z_Nm));
    EXPECT_EQ(sample.moment_x_Nm, filters[4].update(raw.sample().moment_x_Nm));
  }
  config.filter_cutoff_hz = 125.0;
  EXPECT_THROW(TactileReceiver(config, kPeriod_s), std::invalid_argument);
}

TEST(TactileReceiver, TheOffsetDoesNotRingInTheFilterAfterATare) {
  CanTactileConfig config = tactileConfig();
  config.filter_cutoff_hz = 15.0;
  TactileReceiver receiver(config, kPeriod_s);
  int sequence = 0;
  ASSERT_EQ(tare(receiver, sequence, std::vector<Counts>(50, forceY(1.9))), TareState::kDone);
  for (int i = 0; i < 50; ++i) {
    receive(receiver, tactileFrames(++sequence, forceY(1.9)));
    EXPECT_NEAR(receiver.sample().force_y_N, 0.0, 1e-9);
  }
}

/// Once the cable is whole again nothing is felt that nobody pushed: that would be retreated from.
TEST(TactileReceiver, WhatABrokenCableSaysDoesNotRingInTheFilter) {
  CanTactileConfig config = tactileConfig();
  config.filter_cutoff_hz = 15.0;
  for (const int broken_samples : {1, 10}) {
    TactileReceiver receiver(config, kPeriod_s);
    int sequence = 0;
    for (int i = 0; i < 100; ++i) receive(receiver, tactileFrames(++sequence, forceY(0.5)));
    for (int i = 0; i < broken_samples; ++i)
      receive(receiver, tactileFrames(++sequence, forceY(200.0), 0x02));
    EXPECT_EQ(receiver.fault(), Fault::kTactileCableBreak);
    for (int i = 0; i < 50; ++i) {
      receive(receiver, tactileFrames(++sequence, forceY(0.5)));
      EXPECT_NEAR(receiver.sample().force_y_N, 0.5, 1e-3) << i;
    }
  }
}

/// One frame, most of them of the module, some of anything.
CanFrame randomFrame(std::mt19937& random, int& sequence) {
  CanFrame frame = tactileFrames(sequence, kTouch)[random() % 4];
  if (random() % 8 == 0) ++sequence;
  for (std::size_t i = 1; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
  if (random() % 4 != 0) frame.data[1] = 0;
  switch (random() % 30) {
    case 0:
      frame.id = random() & 0x7FF;
      break;
    case 1:
      frame.size = static_cast<std::uint8_t>(random());
      break;
    case 2:
      frame.kind = static_cast<FrameKind>(random() % 3);
      break;
    case 3:
      frame.extended = true;
      break;
    case 4:
      frame.data[0] = static_cast<std::uint8_t>(random());
      break;
    default:
      break;
  }
  return frame;
}

/// Whatever comes: samples are finite and count up one by one, each from four frames of its own,
/// and every frame is counted at most once. Without heap.
TEST(TactileReceiver, KeepsItsPromisesUnderRandomFrames) {
  CanTactileConfig config = tactileConfig();
  config.filter_cutoff_hz = 40.0;
  TactileReceiver receiver(config, kPeriod_s);
  std::mt19937 random(13);
  int sequence = 0;
  std::uint64_t frames = 0;
  for (; frames < 500'000; ++frames) {
    const CanFrame frame = randomFrame(random, sequence);
    const std::uint32_t before = receiver.sample().sequence;
    {
      const test::AllocationGuard guard;
      receiver.receive(frame);
      if (frames % 997 == 0) receiver.startTare();
      if (frames % 99'991 < 2 * kLongSilence) receiver.tick();
    }
    const TactileSample& sample = receiver.sample();
    ASSERT_LE(sample.sequence - before, 1u);
    ASSERT_TRUE(std::isfinite(sample.force_y_N + sample.force_z_N + sample.moment_y_Nm +
                              sample.moment_z_Nm));
  }
  const TactileCounters& counters = receiver.counters();
  EXPECT_EQ(counters.samples, receiver.sample().sequence);
  EXPECT_LE(4ULL * counters.samples + counters.incomplete + counters.malformed + counters.repeated,
            frames);
  EXPECT_GT(counters.samples, 1000u);
  EXPECT_GT(counters.incomplete, 1000u);
  EXPECT_GT(counters.malformed, 1000u);
  EXPECT_GT(counters.repeated, 1000u);
}

/// To the cycle, and from the last frame on.
TEST(TactileReceiver, ForgetsNumbersAtTheEndOfALongSilence) {
  for (const bool is_over : {false, true}) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    for (int again = 0; again < 2; ++again) {
      receive(receiver, tactileFrames(77 + again, kTouch));
      waitSilently(receiver, TactileReceiver::kMaxSilentSamples * kCyclesPerSample - 1);
    }
    if (is_over) waitSilently(receiver, 1);
    receive(receiver, tactileFrames(77, kTouch));
    EXPECT_EQ(receiver.sample().sequence, is_over ? 3u : 2u);
  }
}

TEST(TactileReceiver, CountsAsIncompleteWhatHadBegunBeforeASilence) {
  for (int begun = 0; begun < 4; ++begun) {
    TactileReceiver receiver(tactileConfig(), kPeriod_s);
    const TactileFrames frames = tactileFrames(77, kTouch);
    for (int k = 0; k < begun; ++k) receiver.receive(frames[k]);
    waitSilently(receiver, 2 * kLongSilence);
    EXPECT_EQ(receiver.counters().incomplete, begun == 0 ? 0u : 1u) << begun;
  }
}

TEST(TactileReceiver, TaresUpToItsLimitsAndNamesTheOneThatWasPassed) {
  TactileReceiver receiver(tactileConfig(), kPeriod_s);
  int sequence = 0;
  std::vector<Counts> samples(50, forceY(2.0));  // at the limit of the offset
  EXPECT_EQ(tare(receiver, sequence, samples), TareState::kDone);
  samples.assign(50, forceY(0.2));
  samples[0] = forceY(0.0);  // at the limit of the spread
  EXPECT_EQ(tare(receiver, sequence, samples), TareState::kDone);
  samples.assign(50, forceY(2.0));
  samples[0] = forceY(1.5);
  EXPECT_EQ(tare(receiver, sequence, samples), TareState::kRefused);
  EXPECT_EQ(receiver.tareRefusal().value, 0.5) << "of the spread: the offset is within its limit";
  receiver.startTare();
  receive(receiver, tactileFrames(++sequence, forceY(0.0)));
  receive(receiver, tactileFrames(++sequence, forceY(0.2), 0x01));
  EXPECT_EQ(receiver.tareState(), TareState::kRefused);
  EXPECT_STREQ(receiver.tareRefusal().unit, "") << "saturated: both are within their limits";
}

/// Half a year of samples, and on.
TEST(TactileReceiver, NeverCountsASampleAsNone) {
  EXPECT_EQ(sampleAfter(0), 1u);
  EXPECT_EQ(sampleAfter(41), 42u);
  EXPECT_EQ(sampleAfter(0xFFFFFFFE), 0xFFFFFFFF);
  EXPECT_EQ(sampleAfter(0xFFFFFFFF), 1u);
}

}  // namespace
}  // namespace tactus
