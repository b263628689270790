#pragma once

#include <cstdint>

namespace tactus {

/// A scripted trouble of the plant; see the loader's `simulation.troubles`.
struct Trouble {
  enum class Kind : std::uint8_t {
    kDrop,        ///< frames of the id vanish
    kDelay,       ///< frames of the id come delay_s late
    kReorder,     ///< pairs of frames of the bus swap
    kCorrupt,     ///< bits of the id's frames flip (beyond what the CRC of CAN would catch)
    kDuplicate,   ///< frames of the id come twice
    kBusOff,      ///< the other side's controller leaves the bus and drops its frames
    kPowerCut,    ///< all nodes of the bus lose power; frames are not acknowledged
    kDriveFault,  ///< the drive with this node id reports a fault and stops by itself
    // Drives that deceive their master; of the one with this node id:
    kIgnoreCommands,  ///< obeys neither control words nor RPDOs, keeps its last velocity
    kFreezeFeedback,  ///< its TPDO says where it was, in which state, when this began
    kNonsenseStatus,  ///< its TPDO has a status word that the standard does not know
    kBootUp,          ///< it sends a boot-up message when this begins, and runs on
    kHeartbeatOnly,   ///< it watches the master's heartbeat, but neither SYNC nor RPDO
    kEmergencyStop,
  };
  Kind kind = Kind::kDrop;
  double from_s = 0.0;  ///< since the first drive was enabled
  double until_s = 0.0;
  int bus = 0;
  std::uint32_t id = 0;  ///< of frames, or node id; 0: all of the bus
  double delay_s = 0.0;
};

}  // namespace tactus
