#include "tactus/io/debounce.h"

#include <algorithm>

namespace tactus {

bool Debounce::update(bool level) noexcept {
  changed_cycles_ = level == is_active_ ? 0 : changed_cycles_ + 1;
  const int needed = std::max(1, is_active_ ? release_cycles_ : activation_cycles_);
  if (changed_cycles_ >= needed) {
    is_active_ = level;
    changed_cycles_ = 0;
  }
  return is_active_;
}

}  // namespace tactus
