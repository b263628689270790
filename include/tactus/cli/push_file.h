#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/calibration_fit.h"
#include "tactus/analysis/channel_window.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A push of a file, and where it stands there.
struct RecordedPush {
  KnownPush push;  ///< counts less those of the zero before it
  SourcePosition at;
};

/// What `tactus calibrate record` has written so far: times without load, and pushes, each measured
/// against the last of these.
struct PushFile {
  std::string path, link;
  std::vector<RecordedPush> pushes;
  std::optional<ChannelFigures> zero;  ///< the last one
  /// Of the channels without load, the quadratic mean over all zeros, counts.
  ChannelVector sigma = ChannelVector::Zero();
};

/// "channel 3 is at its end, at 8388607 counts"
std::string defectText(const ChannelDefect& defect);

/// Throws InputError at the first value that is none, and where a channel stopped.
PushFile readPushFile(const std::string& path);
PushFile readPushFile(const SourceFile& source);

/// Texts that such a file is made of: what it begins with, and a record of each kind.
std::string pushFileBeginning(const std::string& link);
std::string zeroRecord(const ChannelFigures& figures);
/// push: what was said; its counts do not matter.
std::string pushRecord(const KnownPush& push, const ChannelFigures& figures);

std::vector<KnownPush> pushesOf(const PushFile& file);

}  // namespace tactus
