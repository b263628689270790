#pragma once

#include <array>
#include <vector>

/// A GPIO chip in memory behind the functions of libgpiod that the daemon calls. fake_gpiod_v1.cpp
/// and fake_gpiod_v2.cpp, one for each interface of it, take the place of the library's in the
/// whole program.
namespace tactus::test {

enum class Requested { kNo, kInput, kEdges, kOutput };

struct FakeLine {
  int level = 0;
  Requested requested = Requested::kNo;
  bool is_taken = false;  ///< by the kernel
  int pull = 0;           ///< 1: up, -1: down, if nothing drives it
};

struct FakeChip {
  static constexpr unsigned kLines = 8;

  bool is_present = true;
  bool is_open = false;
  bool has_events = true;
  bool refuses_pulls = false;
  bool is_gone = false;  ///< in mid run: all calls fail
  int calls = 0;         ///< that are system calls in a cycle
  std::array<FakeLine, kLines> lines{};
  std::vector<int> events;  ///< of the line that was requested with edges: its new levels
  int descriptor = -1;
};

inline FakeChip fake_chip;

/// A new chip with all lines low.
FakeChip& resetFakeChip();

/// Drives an input from outside, with the edge that it makes.
void drive(unsigned line, int level);
/// Its wire comes off.
void unplug(unsigned line);

// For the functions of libgpiod:

/// False, and errno: there is none of that name.
bool openFakeChip(const char* name);
/// A chip that has gone refuses every call.
bool answers();
/// False, and errno: taken, or without edges or resistors.
bool requestLine(FakeLine& line, Requested as, int level, int pull);
/// The descriptor of the line with edges.
int edgeDescriptor();
/// Up to `count` new levels. Empty, and errno: none, or the descriptor would wait for ever.
std::vector<int> readEdges(int descriptor, unsigned long count);

}  // namespace tactus::test
