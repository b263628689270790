#pragma once

#include <errno.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What we ask of libgpiod, whose versions 1 and 2 have nothing in common but the name of their
/// header: gpio_chip_v1.cpp and gpio_chip_v2.cpp each implement it for one of them. Levels are
/// those on the wire; a line's polarity is not known here.
namespace tactus {

enum class GpioDirection { kInput, kOutput, kInputWithEdges };

struct GpioEdges {
  bool has_risen = false, has_fallen = false;
};

/// Lines of a chip that this process holds, read or written by one system call.
class GpioRequest {
 public:
  virtual ~GpioRequest() = default;

  /// One for each line, in the order of the request. False, and errno: the chip refuses.
  virtual bool read(std::span<bool> levels) noexcept = 0;
  virtual bool write(std::span<const bool> levels) noexcept = 0;
  /// Those since the last call, as many as the kernel keeps. Never waits; one system call.
  virtual bool readEdges(GpioEdges& edges) noexcept = 0;
};

class GpioChip {
 public:
  virtual ~GpioChip() = default;

  virtual int lineCount() = 0;
  /// Who holds this line; nullopt: nobody.
  virtual std::optional<std::string> user(int line) = 0;
  /// levels: what outputs begin with, and to where the chip pulls an input that nothing drives, if
  /// it can; of several inputs all alike. nullptr, and errno: not to be had.
  virtual std::unique_ptr<GpioRequest> request(const std::vector<int>& lines,
                                               GpioDirection direction,
                                               std::span<const bool> levels) = 0;
};

/// After a request of inputs that has failed, whether it may succeed without a pull: most drivers
/// pass over one that they do not have, some refuse it.
inline bool mayLackPull(GpioDirection direction) noexcept {
  const bool is_unknown = errno == EINVAL || errno == ENOTSUP;
  return direction != GpioDirection::kOutput && is_unknown;
}

/// "gpiochip0". nullptr, and errno: cannot be opened.
std::unique_ptr<GpioChip> findGpioChip(const std::string& name);

// These throw std::runtime_error, which names the chip and what to do.
[[noreturn]] void failOnChip(const std::string& name, const std::string& problem);
std::unique_ptr<GpioChip> openGpioChip(const std::string& name);
void requireGpioLine(GpioChip& chip, const std::string& name, int line);

inline constexpr const char* kGpioConsumer = "tactusd";  ///< as gpioinfo shows it
inline constexpr unsigned kMaxGpioEdges = 16;  ///< read a cycle: as many as the kernel keeps
inline constexpr unsigned kMaxGpioLines = 2;   ///< in a request

}  // namespace tactus
