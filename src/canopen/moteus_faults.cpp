#include "tactus/canopen/moteus_faults.h"

namespace tactus {

const std::array<MoteusFaultRow, 26>& moteusFaultTable() noexcept {
  static constexpr std::array<MoteusFaultRow, 26> kTable = {{
      {1, "DMA stream transfer error"},
      {2, "DMA stream FIFO error"},
      {3, "UART overrun"},
      {4, "UART framing error"},
      {5, "UART noise"},
      {6, "UART buffer overrun"},
      {7, "UART parity error"},
      {32, "calibration fault"},
      {33, "motor driver fault"},
      {34, "over voltage"},
      {35, "encoder fault"},
      {36, "motor not configured"},
      {37, "PWM cycle overrun"},
      {38, "over temperature"},
      {39, "start outside of position limits"},
      {40, "under voltage"},
      {41, "configuration changed in operation"},
      {42, "theta invalid: no valid commutation encoder"},
      {43, "position invalid: no valid output encoder"},
      {44, "gate driver could not be enabled"},
      {45, "stop position with velocity or acceleration limits"},
      {46, "timing violation"},
      {47, "back-EMF feedforward without an acceleration limit"},
      {48, "invalid position limits"},
      {49, "position control error"},
      {50, "velocity control error"},
  }};
  return kTable;
}

const char* moteusFaultName(int code) noexcept {
  for (const MoteusFaultRow& row : moteusFaultTable())
    if (row.code == code) return row.name;
  return nullptr;
}

}  // namespace tactus
