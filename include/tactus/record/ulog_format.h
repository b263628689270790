#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

/// What writer and reader of a log agree on: the PX4 ULog format, version 1
/// (https://docs.px4.io/main/en/dev_log/ulog_file_format), with the topic kCycleTopic, and those
/// of side_topic.h with what stays as it is for many cycles.
///
/// A file is a header (magic, version, uint64 start time in us) and messages: uint16 size of the
/// payload, char type, payload; all little-endian. The files a run was made of are stored as pairs
/// of multi-informations kSourcePathKey, kSourceTextKey, in the order of Scene::sources; values
/// given by --set as kOverrideKeyKey, kOverrideValueKey. The logs of one run of the daemon have the
/// same information kRunKey, and kPartKey counts them from 0. Informations fault/<number> and
/// mode/<number> name what the fields fault and mode hold, unit/<field> the units, joint/<i> and
/// component/<i>, from 1, what the entries of arrays are of.
namespace tactus {

static_assert(std::endian::native == std::endian::little, "the log is written as memory lies");

inline constexpr std::array<std::uint8_t, 8> kUlogMagic = {0x55, 0x4c, 0x6f, 0x67,
                                                           0x01, 0x12, 0x35, 0x01};
inline constexpr std::size_t kUlogHeaderSize = 16;
inline constexpr std::size_t kMessageHeaderSize = 3;
inline constexpr std::size_t kMaxMessageSize = 65535;
inline constexpr std::size_t kFlagBitsSize = 40;

inline constexpr char kCycleTopic[] = "cycle";
inline constexpr char kGainsTopic[] = "gains";
inline constexpr char kToolMotionTopic[] = "tool_motion";
inline constexpr char kSourcePathKey[] = "source_path";
inline constexpr char kSourceTextKey[] = "source_text";
inline constexpr char kOverrideKeyKey[] = "override_key";
inline constexpr char kOverrideValueKey[] = "override_value";
inline constexpr char kRunKey[] = "run";
inline constexpr char kPartKey[] = "part";

}  // namespace tactus
