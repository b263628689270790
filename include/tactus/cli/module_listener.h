#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tactus/analysis/channel_window.h"
#include "tactus/canopen/tactile_receiver.h"

namespace tactus {

/// Frames of a bus as time goes by: those of a socket, or in virtual time.
struct FrameSource {
  std::function<void()> forget;  ///< what has come until now
  /// Waits for some, not longer than 0.1 s; returns the time since some beginning, s.
  std::function<double(FrameBatch& frames)> next;
};

/// Of an interface; sends nothing. Throws std::system_error whose text says what to do.
FrameSource framesOf(const std::string& interface, std::uint32_t first_id);

/// A tactile module on its bus, for whoever only listens.
struct ListenedModule {
  std::string interface;
  CanTactileConfig config;
};

/// What it said for duration_s: the counts of each complete sample. Throws RunError if none comes
/// for a second, or one says that a cable is broken.
ChannelWindow listen(const FrameSource& source, const ListenedModule& module, double duration_s);

}  // namespace tactus
