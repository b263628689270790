#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tactus/canopen/can_frame.h"

namespace tactus::test {

inline CanFrame rawFrame(std::uint32_t id, const std::vector<int>& bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    frame.data[i] = static_cast<std::uint8_t>(bytes[i]);
  return frame;
}

/// A CiA 402 drive as far as the tests need one, written from the standards with no code of the
/// master's. What is sent to it goes in by hear(); what it sends is taken out in order. A control
/// word acts at the SYNC after it; feedback shows the drive as it was before that.
class ScriptedDrive {
 public:
  using Entry = std::pair<int, int>;  ///< index, subindex
  enum Power { kNotReady, kDisabled, kReady, kOn, kEnabled, kQuickStop, kReaction, kFault };

  explicit ScriptedDrive(int node_id) : node_(node_id) { resetObjects(); }

  // What a test may set.
  std::map<Entry, std::uint32_t> refused;  ///< entries whose access is aborted, with the code
  std::map<Entry, std::uint32_t> refused_writes, refused_reads;
  std::set<Entry> unanswered;
  bool is_powered = true;
  bool sends_feedback = true;
  bool sends_heartbeat = true;
  bool shows_mode = true;
  bool ignores_commands = false;  ///< of RPDOs: it goes on with its last velocity
  bool ignores_nmt = false;
  int quick_stop_cycles = 5;
  bool stays_in_quick_stop = false;  ///< quick stop option codes 5 to 8
  int resets_refused = 0;
  std::int32_t position = 0;  ///< counts
  double period_s = 0.001;

  // What a test may look at.
  std::vector<std::pair<Entry, std::uint32_t>> writes;
  Power power = kDisabled;
  int nmt = 127;
  std::int32_t velocity = 0;  ///< counts/s, of the last RPDO
  int control = 0;
  int resets = 0;  ///< rising edges of bit 7 in fault
  int aborts_heard = 0;
  std::map<Entry, std::uint32_t> objects;

  void powerUp() {
    resetObjects();
    is_powered = true;
    power = kDisabled;
    nmt = 127;
    velocity = 0;
    latched_.reset();
    say(0x700, {0});
  }

  void fault(int code) {
    power = kReaction;
    reaction_cycles_ = 3;
    say(0x080, {code & 0xFF, code >> 8, 0x01, 0, 0, 0, 0, 0});
  }

  void hear(const CanFrame& frame) {
    if (!is_powered) return;
    const bool is_mine = frame.size == 2 && (frame.data[1] == 0 || frame.data[1] == node_);
    if (frame.id == 0 && is_mine) return command(frame.data[0]);
    if (frame.id == 0x600u + node_) return serve(frame);
    const bool takes_pdo = nmt == 5 && isOn(0x1400) && frame.id == (objects[{0x1400, 1}] & 0x7FF);
    if (takes_pdo && frame.size == 6) latched_ = frame;
    if (frame.id == 0x080 && frame.size == 0) sync();
  }

  std::vector<CanFrame> take() { return std::exchange(said_, {}); }
  void say(std::uint32_t function, const std::vector<int>& bytes) {
    if (is_powered) said_.push_back(rawFrame(function + node_, bytes));
  }

 private:
  bool isOn(int communication) { return (objects[{communication, 1}] >> 31) == 0; }

  void resetObjects() {
    objects = {{{0x1000, 0}, 0x00020192}, {{0x1400, 1}, 0x200u + node_},
               {{0x1400, 2}, 255},        {{0x1400, 5}, 0},
               {{0x1600, 0}, 1},          {{0x1600, 1}, 0x60400010},
               {{0x1600, 2}, 0},          {{0x1800, 1}, 0x180u + node_},
               {{0x1800, 2}, 255},        {{0x1801, 1}, 0x280u + node_},
               {{0x1A00, 0}, 1},          {{0x1A00, 1}, 0x60410010},
               {{0x1A00, 2}, 0},          {{0x6040, 0}, 0},
               {{0x6060, 0}, 0},          {{0x6061, 0}, 0},
               {{0x60B1, 0}, 0},          {{0x60B2, 0}, 0},
               {{0x60C2, 1}, 10},         {{0x60C2, 2}, 0xFE},
               {{0x605A, 0}, 2},          {{0x605E, 0}, 2},
               {{0x607F, 0}, 0xFFFFFFFF}, {{0x6007, 0}, 1},
               {{0x1016, 1}, 0},          {{0x1017, 0}, 0}};
  }

  /// Bytes of an object that is read.
  static int sizeOf(int index) {
    return index == 0x6061 || index == 0x60C2 ? 1 : index == 0x60B2 ? 2 : 4;
  }

  void command(int command) {
    if (ignores_nmt) return;
    if (command == 2 && power == kEnabled) power = kReaction;  // the reaction of object 6007
    if (command == 1) nmt = 5;
    if (command == 2) nmt = 4;
    if (command == 128) nmt = 127;
    if (command == 129 || command == 130) powerUp();
  }

  void serve(const CanFrame& frame) {
    const auto& d = frame.data;
    const Entry entry{d[1] | d[2] << 8, d[3]};
    if (d[0] == 0x80) ++aborts_heard;
    if (d[0] == 0x80 || unanswered.count(entry) != 0) return;
    if (refused.count(entry) != 0) return abort(frame, refused[entry]);
    if (objects.count(entry) == 0) return abort(frame, 0x06020000);
    if (d[0] == 0x40 && refused_reads.count(entry) != 0) return abort(frame, refused_reads[entry]);
    if (d[0] == 0x40) {
      const std::uint32_t v = objects[entry];
      const int size = sizeOf(entry.first);
      return say(0x580, {0x43 | (4 - size) << 2, d[1], d[2], d[3], int(v & 0xFF),
                         int(v >> 8 & 0xFF), int(v >> 16 & 0xFF), int(v >> 24)});
    }
    if (refused_writes.count(entry) != 0) return abort(frame, refused_writes[entry]);
    const std::map<int, int> sizes{{0x2F, 1}, {0x2B, 2}, {0x27, 3}, {0x23, 4}};
    std::uint32_t value = 0;
    for (int i = 0; i < sizes.at(d[0]); ++i) value |= std::uint32_t{d[4 + i]} << 8 * i;
    objects[entry] = value;
    writes.push_back({entry, value});
    if (entry.first == 0x6060 && shows_mode) objects[{0x6061, 0}] = value;
    if (entry.first == 0x6040) drive(static_cast<int>(value));
    say(0x580, {0x60, d[1], d[2], d[3], 0, 0, 0, 0});
  }

  void abort(const CanFrame& frame, std::uint32_t code) {
    const auto& d = frame.data;
    say(0x580, {0x80, d[1], d[2], d[3], int(code & 0xFF), int(code >> 8 & 0xFF),
                int(code >> 16 & 0xFF), int(code >> 24)});
  }

  void sync() {
    const std::uint32_t heartbeat_ms = objects[{0x1017, 0}];
    if (heartbeat_ms != 0 && ++heartbeat_ >= static_cast<int>(heartbeat_ms)) {
      heartbeat_ = 0;
      if (sends_heartbeat) say(0x700, {nmt});
    }
    if (nmt == 5 && isOn(0x1800) && sends_feedback) feedback();
    advance();
    if (nmt != 5 || !latched_ || ignores_commands) return;
    drive(latched_->data[0] | latched_->data[1] << 8);
    velocity =
        static_cast<std::int32_t>(latched_->data[2] | latched_->data[3] << 8 |
                                  latched_->data[4] << 16 | std::uint32_t{latched_->data[5]} << 24);
    latched_.reset();
  }

  void feedback() {
    static constexpr int kStatus[] = {0x0000, 0x0040, 0x0021, 0x0023,
                                      0x0027, 0x0007, 0x000F, 0x0008};
    const int status = kStatus[power] | 0x1610;  // voltage, remote, and the manufacturer's bits
    const auto p = static_cast<std::uint32_t>(position);
    say(0x180, {status & 0xFF, status >> 8, int(p & 0xFF), int(p >> 8 & 0xFF), int(p >> 16 & 0xFF),
                int(p >> 24)});
  }

  void advance() {
    if (power == kEnabled) {
      exact_ += velocity * period_s;
      const auto moved = static_cast<std::int32_t>(exact_);
      exact_ -= moved;
      position += moved;
    }
    if (power == kNotReady) power = kDisabled;
    if (power == kReaction && --reaction_cycles_ <= 0) power = kFault;
    if (power == kQuickStop && !stays_in_quick_stop && --stop_cycles_ <= 0) power = kDisabled;
  }

  /// Commands of CiA 402-2 by their bits.
  void drive(int word) {
    const bool reset_rises = (word & 0x80) != 0 && (control & 0x80) == 0;
    control = word;
    if (power == kFault && reset_rises) {
      ++resets;
      if (resets_refused-- <= 0) power = kDisabled;
      return;
    }
    if (power == kFault || power == kReaction || power == kNotReady) return;
    const bool no_voltage = (word & 0x02) == 0;
    const bool quick_stop = (word & 0x06) == 0x02;
    const bool shutdown = (word & 0x07) == 0x06;
    const bool switch_on = (word & 0x07) == 0x07;
    const bool operate = (word & 0x0F) == 0x0F;
    if (power == kDisabled) {
      if (shutdown) power = kReady;
    } else if (no_voltage) {
      power = kDisabled;
    } else if (power == kReady) {
      if (quick_stop) power = kDisabled;
      if (switch_on) power = kOn;
    } else if (power == kOn) {
      if (quick_stop) power = kDisabled;
      if (shutdown) power = kReady;
      if (operate) power = kEnabled;
    } else if (power == kEnabled) {
      if (quick_stop) power = kQuickStop;
      if (quick_stop) stop_cycles_ = quick_stop_cycles;
      if (shutdown) power = kReady;
      if (switch_on && !operate) power = kOn;
    }
  }

  int node_;
  std::vector<CanFrame> said_;
  std::optional<CanFrame> latched_;
  int heartbeat_ = 0;
  int reaction_cycles_ = 0;
  int stop_cycles_ = 0;
  double exact_ = 0.0;
};

}  // namespace tactus::test
