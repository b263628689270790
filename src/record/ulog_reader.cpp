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
  // A run that was interrupted ends within a cycle or its gains; anything else is a damaged size.
  const std::size_t size = message.payload.size() - sizeof(std::uint16_t);
  const bool is_whole = size == definitions_.topic.size ||
                        (definitions_.has_gains && size == definitions_.gains.size);
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
  if (definitions_.has_gains && id == definitions_.gains_id) {
    checkSize(message, "gains", definitions_.gains.size);
    copy(fields, definitions_.gains.runs, &gains_);
    knows_gains_ = true;
  }
  if (id != definitions_.cycle_id) return false;
  checkSize(message, "a cycle", definitions_.topic.size);
  if (definitions_.has_gains && !knows_gains_)
    messages_.fail(message.offset, "message D", "a cycle, its gains are expected before it");
  copy(fields, definitions_.topic.runs, &record);
  record.gains = gains_;
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
    failAt({std::make_shared<std::string>(path), 1, 1}, "-", problem.what(),
           "expected a log of tactus");
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
  failAt({std::make_shared<std::string>(path), 1, 1}, kCycleTopic, "the log holds none",
         "expected at least one");
}

LogExtent checkLog(const std::string& path) {
  std::ifstream in = openLog(path);
  UlogReader reader(in, path);
  const LogExtent extent = readToEnd(reader);
  if (extent.cycles == 0) refuseEmptyLog(path);
  return extent;
}

}  // namespace tactus
