#pragma once

#include <string_view>

namespace tactus {

/// A word to the service manager, by the protocol of sd_notify(3), but without waiting where it
/// does not read: false, it cannot be told at present. True without a NOTIFY_SOCKET in the
/// environment, or where nobody listens there.
bool tellManager(std::string_view state) noexcept;

}  // namespace tactus
