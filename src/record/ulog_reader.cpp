#include "tactus/record/ulog_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "tactus/record/ulog_format.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/source_reader.h"

namespace tactus {
namespace {

void copy(std::string_view fields, const std::vector<CopyRun>& runs, void* to) noexcept {
  for (const CopyRun& run : runs) {
    std::memcpy(static_cast<char*>(to) + run.record_offset, fields.data() + run.message_offset,
                run.size);
  }
}

}  // namespace

UlogReader::UlogReader(std::istream& in, std::string name)
    : messages_(in, std::move(name)), definitions_(readDefinitions(messages_)) {}

bool UlogReader::has(std::string_view field) const noexcept {
  return std::ranges::count(definitions_.topic.absent, field) == 0;
}

bool UlogReader::next(CycleRecord& record) {
  UlogMessage message;
  while (messages_.next(message)) {
    if (message.type != 'D') {
      messages_.checkIgnorable(message);
    } else if (take(message, record)) {
      return true;
    }
  }
  // A run that was interrupted ends within a cycle or a part of it; anything else is a damaged
  // size.
  const std::size_t size = message.payload.size() - sizeof(std::uint16_t);
  const bool is_whole =
      size == definitions_.topic.size ||
      std::ranges::any_of(definitions_.sides, [size](const UlogDefinitions::Side& side) {
        return side.is_there && size == side.layout.size;
      });
  if (message.type != 0 && (message.type != 'D' || !is_whole)) {
    messages_.fail(message.offset, "message", "longer than the log, an undamaged log is expected");
  }
  return false;
}

bool UlogReader::take(const UlogMessage& message, CycleRecord& record) {
  std::uint16_t id = 0;
  if (message.payload.size() < sizeof(id)) {
    messages_.fail(message.offset, "message D", "too short, a message id is expected");
  }
  std::memcpy(&id, message.payload.data(), sizeof(id));
  const std::string_view fields = message.payload.substr(sizeof(id));
  for (int i = 0; i < kSideTopics; ++i) {
    const UlogDefinitions::Side& side = definitions_.sides[i];
    if (!side.is_there || id != side.id) continue;
    checkSize(message, sideTopics()[i].what, side.layout.size);
    copy(fields, side.layout.runs, reinterpret_cast<char*>(&sides_) + sideTopics()[i].offset);
    is_known_[i] = true;
  }
  if (id != definitions_.cycle_id) return false;
  checkSize(message, "a cycle", definitions_.topic.size);
  for (int i = 0; i < kSideTopics; ++i) {
    if (definitions_.sides[i].is_there && !is_known_[i])
      messages_.fail(
          message.offset, "message D",
          fmt::format("a cycle, its {} expected before it", i == 0 ? "gains are" : "motion is"));
  }
  copy(fields, definitions_.topic.runs, &record);
  for (const SideTopic& topic : sideTopics())
    std::memcpy(reinterpret_cast<char*>(&record) + topic.offset,
                reinterpret_cast<const char*>(&sides_) + topic.offset, topic.size);
  return true;
}

void UlogReader::checkSize(const UlogMessage& message, const char* what,
                           std::size_t fields_size) const {
  const std::size_t expected = sizeof(std::uint16_t) + fields_size;
  if (message.payload.size() == expected) return;
  messages_.fail(
      message.offset, "message D",
      fmt::format("{} in {} bytes, {} are expected", what, message.payload.size(), expected));
}

std::ifstream openLog(const std::string& path) {
  try {
    requireRegularFile(path);
    std::ifstream in(path, std::ios::binary);
    if (!in) throw FileProblem(std::string("cannot be opened: ") + std::strerror(errno));
    return in;
  } catch (const FileProblem& problem) {
    failAt(beginOf(path), "-", problem.what(), "expected a log of tactus");
  }
}

LogExtent readToEnd(UlogReader& reader) {
  CycleRecord record;
  LogExtent extent;
  while (reader.next(record)) ++extent.cycles;
  extent.cut_off = reader.cutOff();
  return extent;
}

void refuseEmptyLog(const std::string& path) {
  failAt(beginOf(path), kCycleTopic, "the log holds none", "expected at least one");
}

LogExtent checkLog(const std::string& path) {
  std::ifstream in = openLog(path);
  UlogReader reader(in, path);
  const LogExtent extent = readToEnd(reader);
  if (extent.cycles == 0) refuseEmptyLog(path);
  return extent;
}

}  // namespace tactus
