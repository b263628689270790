#include "tactus/canopen/sdo_abort.h"

namespace tactus {

const std::array<SdoAbortRow, 31>& sdoAbortTable() noexcept {
  static constexpr std::array<SdoAbortRow, 31> kTable = {{
      {0x05030000, "toggle bit not alternated"},
      {sdo_abort::kTimedOut, "SDO protocol timed out"},
      {sdo_abort::kCommandUnknown, "command specifier not valid or unknown"},
      {0x05040002, "invalid block size"},
      {0x05040003, "invalid sequence number"},
      {0x05040004, "CRC error"},
      {0x05040005, "out of memory"},
      {sdo_abort::kAccessUnsupported, "unsupported access to an object"},
      {0x06010001, "attempt to read a write-only object"},
      {sdo_abort::kReadOnly, "attempt to write a read-only object"},
      {sdo_abort::kObjectMissing, "object does not exist"},
      {0x06040041, "object cannot be mapped to the PDO"},
      {0x06040042, "mapped objects exceed the length of the PDO"},
      {0x06040043, "parameters incompatible"},
      {0x06040047, "incompatibility inside the device"},
      {0x06060000, "access failed by a hardware error"},
      {sdo_abort::kLengthMismatch, "data type or length does not match"},
      {sdo_abort::kTooLong, "data too long"},
      {sdo_abort::kTooShort, "data too short"},
      {sdo_abort::kSubindexMissing, "sub-index does not exist"},
      {0x06090030, "invalid value"},
      {0x06090031, "value too high"},
      {0x06090032, "value too low"},
      {0x06090036, "maximum less than minimum"},
      {0x060A0023, "resource not available: SDO connection"},
      {0x08000000, "general error"},
      {0x08000020, "data cannot be transferred or stored"},
      {0x08000021, "data cannot be transferred or stored because of local control"},
      {0x08000022, "data cannot be transferred or stored in the present state of the device"},
      {0x08000023, "no object dictionary, or it cannot be generated"},
      {0x08000024, "no data available"},
  }};
  return kTable;
}

const char* sdoAbortName(std::uint32_t code) noexcept {
  for (const SdoAbortRow& row : sdoAbortTable())
    if (row.code == code) return row.name;
  return "unknown abort code";
}

}  // namespace tactus
