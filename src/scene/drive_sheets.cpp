#include "tactus/scene/drive_sheets.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tactus/scene/eds_object.h"
#include "tactus/scene/robot_loader.h"

namespace tactus {
namespace {

constexpr std::int64_t kMaxUnsigned32 = 0xFFFFFFFF;

/// A file by the key that names it.
struct NamedFile {
  std::string key;
  std::string path;
};

/// The files of all drives, each read once.
class SheetFiles {
 public:
  SheetFiles(const YamlNode& root, SourceReader& reader) : root_(root), reader_(reader) {}

  std::shared_ptr<const EdsFile> eds(const NamedFile& file) {
    std::shared_ptr<const EdsFile>& known = eds_[file.path];
    if (!known)
      known = std::make_shared<const EdsFile>(
          parseEds(reader_.readLatin(file.path, file.key, locate(root_, file.key))));
    return known;
  }
  DriveProfile profile(const NamedFile& file) {
    const auto [known, is_new] = profiles_.try_emplace(file.path);
    if (is_new)
      known->second = parseDriveProfile(reader_.read(file.path, file.key, locate(root_, file.key)));
    return known->second;
  }

 private:
  const YamlNode& root_;
  SourceReader& reader_;
  std::map<std::string, std::shared_ptr<const EdsFile>> eds_;
  std::map<std::string, DriveProfile> profiles_;
};

/// Of [DeviceInfo]; 0: not said.
std::int64_t numberOfDevice(const EdsFile& eds, const char* key) {
  const EdsSection* const device = eds.find("DeviceInfo");
  const EdsValue* const value = device ? device->find(key) : nullptr;
  if (!value || value->text.empty()) return 0;
  const auto number = parseEdsNumber(value->text);
  if (!number || number->plus_node_id || number->value < 0 || number->value > kMaxUnsigned32)
    failAt(value->at, std::string("DeviceInfo.") + key, inQuotes(value->text) + " is no number",
           "expected one of 32 bits");
  return number->value;
}

/// What the sheet says twice has to be the same; 0 is how it says nothing.
std::optional<std::uint32_t> identityOf(const EdsFile& eds, std::uint8_t subindex,
                                        const char* key) {
  const auto entry = findEdsObject(eds, 0x1018, subindex);
  const std::int64_t in_entry = entry && entry->initial ? entry->initial->value : 0;
  const std::int64_t in_device = numberOfDevice(eds, key);
  const bool is_of_node = entry && entry->initial && entry->initial->plus_node_id;
  if (is_of_node || in_entry < 0 || in_entry > kMaxUnsigned32)
    failAt(entry->initial_at, entry->name + ".DefaultValue",
           is_of_node ? "differs with the node id" : fmt::format("{} does not fit", in_entry),
           "expected one number of 32 bits");
  if (in_entry != 0 && in_device != 0 && in_entry != in_device) {
    failAt(entry->initial_at, entry->name + ".DefaultValue",
           fmt::format("{:#x} is not DeviceInfo.{} = {:#x}", in_entry, key, in_device),
           "expected the same in both");
  }
  // Without the entry the drive cannot be asked.
  if (!entry || (in_entry == 0 && in_device == 0)) return std::nullopt;
  return static_cast<std::uint32_t>(in_entry != 0 ? in_entry : in_device);
}

}  // namespace

std::vector<DriveSheet> readDriveSheets(const SourceFile& robot, const YamlNode& root,
                                        const RobotConfig& config, const SceneSettings& settings,
                                        SourceReader& reader) {
  SheetFiles files(root, reader);
  std::vector<DriveSheet> sheets(config.drives.joints.size());
  const auto named = [&](std::size_t i, const char* key, const std::optional<std::string>& own,
                         const std::optional<std::string>& common) -> std::optional<NamedFile> {
    if (!own && !common) return std::nullopt;
    const std::string path =
        own ? fmt::format("drives.joints[{}].{}", i, key) : fmt::format("drives.{}", key);
    return NamedFile{
        path, settings.resolve(robot.path, std::string(kRobotPrefix) + path, own ? *own : *common)};
  };
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const DriveSection& drive = config.drives.joints[i];
    if (drive.config.kind == DriveKind::kMoteus) continue;
    if (const auto file = named(i, "eds", drive.eds, config.drives.eds))
      sheets[i].eds = files.eds(*file);
    if (const auto file = named(i, "profile", drive.profile, config.drives.profile))
      sheets[i].profile = files.profile(*file);
  }
  return sheets;
}

void applySheet(const DriveSheet& sheet, DriveConfig& drive) {
  drive.has_quick_stop_option = sheet.profile.has_quick_stop_option;
  drive.has_velocity_unit = sheet.profile.has_velocity_unit;
  drive.has_speed_limit = sheet.profile.has_speed_limit;
  if (!sheet.eds) return;
  drive.vendor_id = identityOf(*sheet.eds, 1, "VendorNumber");
  drive.product_code = identityOf(*sheet.eds, 2, "ProductNumber");
  drive.transmit_pdos = edsPdos(*sheet.eds, 0x1800, drive.transmit_pdos);
}

}  // namespace tactus
