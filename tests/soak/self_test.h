#pragma once

namespace tactus::soak {

/// That what judges a soak can fail. The exit code.
int selfTest();

}  // namespace tactus::soak
