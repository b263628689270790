#pragma once

#include <span>

#include "tactus/control/tactile_reading.h"

/// An arm that goes on without a tactile module that tells nothing any more, slowly: see
/// ControllerConfig::module_loss.
namespace tactus {

/// A module that is back has to be good for so long before the arm is as fast as ever.
inline constexpr double kModuleProof_s = 1.0;
/// From full speed to none, and back: how fast the share of the speed changes.
inline constexpr double kSpeedShareRise_s = 0.2;

/// Whether the newest sample of a module is there, in time and believed.
bool isGood(const TactileReading& reading, const TactileModuleConfig& module) noexcept;

/// Whether the arm may go on without this module, whatever it says next: nothing has pushed on it
/// of late by more than released_N, nor does it tell of a push beyond its range; a module that is
/// lost already may stay so.
bool mayBeLost(const TactileReading& reading, double released_N) noexcept;

/// The module is lost, its contact forgotten.
void lose(TactileReading& reading) noexcept;

/// Counts the time that a module that was lost has been good.
void prove(double period_s, TactileReading& reading) noexcept;

/// A period later: towards `lost_share` while a module is lost or not proven, else towards 1.
double nextSpeedShare(double lost_share, std::span<const TactileReading> readings, double period_s,
                      double speed_share) noexcept;

}  // namespace tactus
