#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tactus/canopen/sdo_client.h"
#include "tactus/scene/eds_file.h"

namespace tactus {

/// Who may do what with an entry (CiA 306-1, AccessType). kReadInput and kWriteOutput are readable
/// and writable, and mapped to transmit or to receive PDOs alone.
enum class EdsAccess : std::uint8_t {
  kConstant,
  kReadOnly,
  kWriteOnly,
  kReadWrite,
  kReadInput,
  kWriteOutput
};

/// A whole number's type (CiA 301, 7.4.7).
struct EdsType {
  int bytes = 0;
  bool is_signed = false;

  bool operator==(const EdsType&) const = default;
};

/// An entry of the object dictionary that the data sheet describes.
struct EdsObject {
  std::string name;  ///< "60FF", "1018sub1"
  SourcePosition at;
  EdsType type;
  SourcePosition type_at;
  EdsAccess access = EdsAccess::kReadWrite;
  SourcePosition access_at;
  bool is_mappable = false;
  SourcePosition mapping_at;
  /// Absent, or not said: empty. Node ids are not added.
  std::optional<EdsNumber> initial, lowest, highest;
  SourcePosition initial_at, lowest_at, highest_at;

  bool isReadable() const noexcept { return access != EdsAccess::kWriteOnly; }
  bool isWritable() const noexcept {
    return access != EdsAccess::kConstant && access != EdsAccess::kReadOnly;
  }
  /// A value as the type has it: 0xFD of a signed byte is -3.
  std::int64_t inType(std::int64_t value) const noexcept;
  /// One of the numbers above, so; nothing where it is not said, or comes beside the node id.
  std::optional<std::int64_t> ofEachNode(const std::optional<EdsNumber>& number) const noexcept;
};

/// "60FF", "1018sub1": of a variable its index alone.
std::string edsName(std::uint16_t index, std::uint8_t subindex);

/// The number of the last PDO that is described from an object on (0x1400, 0x1800), with all
/// before it; at least `least`.
int edsPdos(const EdsFile& eds, std::uint16_t first, int least);

/// The entry; absent if there is none. Throws InputError where the data sheet contradicts itself:
/// an object in no list or in a list alone, sub-entries that differ from their number, a type that
/// is none, limits without a value between them, a default value outside of them.
std::optional<EdsObject> findEdsObject(const EdsFile& eds, std::uint16_t index,
                                       std::uint8_t subindex);

}  // namespace tactus
