#include "tactus/record/ulog_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

#include "tactus/record/side_topic.h"
#include "tactus/record/tool_error.h"
#include "tactus/record/ulog_format.h"

namespace tactus {
namespace {

constexpr std::size_t kTextChunk = 32768;
constexpr std::uint16_t kCycleId = 0;
constexpr std::uint16_t kFirstSideId = 1;
constexpr const char* kArraysInfo =
    "q[0], dq[0], q_measured[0] are of joint/1, q_1 and so on in CSV; w[0], wd[0], wd_dot[0] of "
    "component/1, w_1 and so on in CSV";
constexpr std::size_t kDataHeaderSize =
    kMessageHeaderSize + sizeof(kCycleId) + sizeof(std::uint64_t);

template <typename Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

void appendKey(std::string& bytes, const std::string& key) {
  if (key.size() > 255) throw std::invalid_argument("ULog: key too long: " + key);
  append(bytes, static_cast<std::uint8_t>(key.size()));
  bytes += key;
}

std::string textKey(std::string_view name, std::string_view value) {
  return fmt::format("char[{}] {}", value.size(), name);
}

std::uint64_t microseconds(double t_s) noexcept {
  const double t_us = t_s * 1e6 + 0.5;
  return t_us >= 0.0 && t_us < 1e18 ? static_cast<std::uint64_t>(t_us) : 0;
}

std::vector<CopyRun> packedRuns(const RecordShape& shape, std::size_t message_offset) {
  std::vector<CopyRun> runs;
  for (const RecordField& field : recordFields()) {
    const std::size_t size = shape.entries(field) * sizeof(double);
    if (size == 0) continue;
    appendRun({field.offset, message_offset, size}, runs);
    message_offset += size;
  }
  return runs;
}

void appendMessage(std::string& bytes, char type, std::string_view payload) {
  if (payload.size() > kMaxMessageSize) throw std::invalid_argument("ULog: message too long");
  append(bytes, static_cast<std::uint16_t>(payload.size()));
  bytes += type;
  bytes += payload;
}

void appendFormat(std::string& bytes, const RecordShape& shape) {
  std::string format = fmt::format("{}:uint64_t timestamp;", kCycleTopic);
  for (const RecordField& field : recordFields()) {
    if (shape.entries(field) == 0) continue;
    format += typeName(field.type);
    if (shape.isArray(field)) format += fmt::format("[{}]", shape.entries(field));
    format += fmt::format(" {};", field.name);
  }
  appendMessage(bytes, 'F', format);
}

std::uint16_t sideId(int side) noexcept { return static_cast<std::uint16_t>(kFirstSideId + side); }

bool isLogged(const SideTopic& topic, bool has_commands) noexcept {
  return has_commands || !topic.is_of_commands;
}

const char* partOf(const CycleRecord& record, const SideTopic& topic) noexcept {
  return reinterpret_cast<const char*>(&record) + topic.offset;
}

void appendSubscription(std::string& bytes, std::uint16_t id, const char* topic) {
  std::string subscription(1, '\0');  // the topic's first and only instance
  append(subscription, id);
  appendMessage(bytes, 'A', subscription + topic);
}

void appendInfo(std::string& bytes, std::string_view name, std::string_view value) {
  std::string payload;
  appendKey(payload, textKey(name, value));
  payload += value;
  appendMessage(bytes, 'I', payload);
}

/// What a reader of the log alone needs to know of its numbers.
void appendNames(std::string& bytes) {
  for (const FaultRow& row : faultTable())
    appendInfo(bytes, fmt::format("fault/{}", static_cast<int>(row.fault)), row.name);
  for (int i = 0; i < kModeCount; ++i)
    appendInfo(bytes, fmt::format("mode/{}", i), modeName(static_cast<Mode>(i)));
  appendInfo(bytes, "arrays", kArraysInfo);
}

void appendMultiInfo(std::string& bytes, std::string_view name, std::string_view value) {
  bool is_continued = false;
  do {
    const std::string_view chunk = value.substr(0, kTextChunk);
    std::string payload(1, is_continued ? '\1' : '\0');
    appendKey(payload, textKey(name, chunk));
    payload += chunk;
    appendMessage(bytes, 'M', payload);
    value.remove_prefix(chunk.size());
    is_continued = true;
  } while (!value.empty());
}

void appendParameter(std::string& bytes, std::string name, double value) {
  std::erase(name, ']');
  std::ranges::replace_if(
      name, [](char c) { return c == '.' || c == '['; }, '/');
  std::string payload;
  appendKey(payload, "float " + name);
  append(payload, static_cast<float>(value));
  appendMessage(bytes, 'P', payload);
}

}  // namespace

LogDescription describeLog(const Scene& scene) {
  LogDescription description;
  const TaskConfig& task = scene.controller.task;
  const int modules = static_cast<int>(scene.controller.tactile_modules.size());
  description.shape = {
      scene.controller.chain.size(),
      task.size,
      task.hasRotation(),
      std::max(1, modules),
      std::ranges::any_of(scene.controller.tactile_modules, &TactileModuleConfig::feels_moment_x),
      scene.controller.module_loss.has_value()};
  description.has_commands = task.commands.has_value();
  description.infos = {{"ver_sw", TACTUS_VERSION},
                       {"scene", scene.name},
                       {"variant", scene.variant},
                       {"robot", scene.robot_name}};
  for (std::size_t i = 0; i < scene.joint_names.size(); ++i) {
    description.infos.emplace_back(fmt::format("joint/{}", i + 1), scene.joint_names[i]);
  }
  for (std::size_t i = 0; i < scene.module_links.size(); ++i) {
    description.infos.emplace_back(fmt::format("tactile_module/{}", i + 1), scene.module_links[i]);
  }
  constexpr std::array kComponents = {"x", "y", "z", "rx", "ry", "rz"};
  for (int i = 0; i < task.size; ++i)
    description.infos.emplace_back(fmt::format("component/{}", i + 1),
                                   kComponents[task.components[i]]);
  description.parameters = scene.numbers;
  description.sources = scene.sources;
  description.overrides = scene.overrides;
  return description;
}

std::string logDefinitions(const LogDescription& description) {
  std::string bytes(reinterpret_cast<const char*>(kUlogMagic.data()), kUlogMagic.size());
  append(bytes, std::uint64_t{0});  // start time: virtual time begins at zero
  appendMessage(bytes, 'B', std::string(kFlagBitsSize, '\0'));
  appendFormat(bytes, description.shape);
  appendInfo(bytes, "sys_name", "tactus");
  for (const auto& [name, value] : description.infos) appendInfo(bytes, name, value);
  for (const RecordField& field : recordFields()) {
    if (*field.unit && description.shape.entries(field) > 0)
      appendInfo(bytes, fmt::format("unit/{}", field.name), field.unit);
  }
  appendNames(bytes);
  for (const auto& [name, value] : description.parameters) appendParameter(bytes, name, value);
  for (const SourceFile& source : description.sources) {
    appendMultiInfo(bytes, kSourcePathKey, source.path);
    appendMultiInfo(bytes, kSourceTextKey, source.text);
  }
  for (const Override& override_ : description.overrides) {
    appendMultiInfo(bytes, kOverrideKeyKey, override_.key);
    appendMultiInfo(bytes, kOverrideValueKey, override_.value);
  }
  for (int i = 0; i < kSideTopics; ++i)
    if (isLogged(sideTopics()[i], description.has_commands))
      appendMessage(bytes, 'F', sideFormat(sideTopics()[i]));
  for (int i = 0; i < kSideTopics; ++i)
    if (isLogged(sideTopics()[i], description.has_commands))
      appendSubscription(bytes, sideId(i), sideTopics()[i].name);
  appendSubscription(bytes, kCycleId, kCycleTopic);
  return bytes;
}

std::size_t logBytesACycle(const RecordShape& shape) {
  const CopyRun last = packedRuns(shape, kDataHeaderSize).back();
  return last.message_offset + last.size;
}

std::size_t logBytesOfSides(const LogDescription& description) {
  std::size_t size = 0;
  for (const SideTopic& topic : sideTopics())
    if (isLogged(topic, description.has_commands)) size += kDataHeaderSize + topic.size;
  return size;
}

UlogWriter::UlogWriter(const std::string& path, const LogDescription& description)
    : file_(path),
      runs_(packedRuns(description.shape, kDataHeaderSize)),
      data_size_(logBytesACycle(description.shape)),
      has_commands_(description.has_commands) {
  file_.showThatItGrows();
  file_.append(logDefinitions(description));
}

void UlogWriter::write(const CycleRecord& record) {
  for (int i = 0; i < kSideTopics; ++i) {
    if (!isOther(record, i)) continue;
    const SideTopic& topic = sideTopics()[i];
    const std::size_t size = kDataHeaderSize + topic.size;
    char* const message = beginData(sideId(i), size, record.t_s);
    std::memcpy(message + kDataHeaderSize, partOf(record, topic), topic.size);
    file_.commit(size);
    std::memcpy(reinterpret_cast<char*>(&sides_) + topic.offset, partOf(record, topic), topic.size);
  }
  has_sides_ = true;
  char* const message = beginData(kCycleId, data_size_, record.t_s);
  const char* bytes = reinterpret_cast<const char*>(&record);
  for (const CopyRun& run : runs_) {
    std::memcpy(message + run.message_offset, bytes + run.record_offset, run.size);
  }
  file_.commit(data_size_);
}

std::size_t UlogWriter::sizeOf(const CycleRecord& record) const noexcept {
  std::size_t size = data_size_;
  for (int i = 0; i < kSideTopics; ++i)
    if (isOther(record, i)) size += kDataHeaderSize + sideTopics()[i].size;
  return size;
}

bool UlogWriter::isOther(const CycleRecord& record, int side) const noexcept {
  const SideTopic& topic = sideTopics()[side];
  if (!isLogged(topic, has_commands_)) return false;
  return !has_sides_ || std::memcmp(partOf(sides_, topic), partOf(record, topic), topic.size) != 0;
}

char* UlogWriter::beginData(std::uint16_t id, std::size_t size, double t_s) {
  char* const message = file_.reserve(size);
  const auto payload_size = static_cast<std::uint16_t>(size - kMessageHeaderSize);
  const std::uint64_t timestamp_us = microseconds(t_s);
  std::memcpy(message, &payload_size, 2);
  message[2] = 'D';
  std::memcpy(message + kMessageHeaderSize, &id, 2);
  std::memcpy(message + kMessageHeaderSize + 2, &timestamp_us, 8);
  return message;
}

}  // namespace tactus
