#pragma once

#include <array>
#include <cstdint>

/// Abort codes of SDO transfers (CiA 301, 7.2.4.3.17).
namespace tactus {

namespace sdo_abort {
inline constexpr std::uint32_t kTimedOut = 0x05040000;
inline constexpr std::uint32_t kCommandUnknown = 0x05040001;
inline constexpr std::uint32_t kAccessUnsupported = 0x06010000;
inline constexpr std::uint32_t kWriteOnly = 0x06010001;
inline constexpr std::uint32_t kReadOnly = 0x06010002;
inline constexpr std::uint32_t kObjectMissing = 0x06020000;
inline constexpr std::uint32_t kLengthMismatch = 0x06070010;
inline constexpr std::uint32_t kTooLong = 0x06070012;
inline constexpr std::uint32_t kTooShort = 0x06070013;
inline constexpr std::uint32_t kSubindexMissing = 0x06090011;
}  // namespace sdo_abort

struct SdoAbortRow {
  std::uint32_t code;
  const char* name;
};

const std::array<SdoAbortRow, 31>& sdoAbortTable() noexcept;
/// What the standard says of a code; "unknown abort code" if nothing.
const char* sdoAbortName(std::uint32_t code) noexcept;

}  // namespace tactus
