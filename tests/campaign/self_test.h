#pragma once

namespace tactus::campaign {

/// Shows each judge the harm that it is there for: 0, or 1 and a line for each that is blind, or
/// that sees harm where there is none.
int selfTest();

}  // namespace tactus::campaign
