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
    } else if (isCycle(message)) {
      copy(message, record);
      return true;
    }
  }
  // A run that was interrupted ends within a cycle; anything else is a damaged size.
  if (message.type != 0 && (message.type != 'D' || message.payload.size() != messageSize())) {
    messages_.fail(message.offset, "message", "longer than the log, an undamaged log is expected");
  }
  return false;
}

bool UlogReader::isCycle(const UlogMessage& message) const {
  std::uint16_t id = 0;
  if (message.payload.size() < sizeof(id)) {
    messages_.fail(message.offset, "message D", "too short, a message id is expected");
  }
  std::memcpy(&id, message.payload.data(), sizeof(id));
  if (id != definitions_.cycle_id) return false;
  if (message.payload.size() != messageSize()) {
    messages_.fail(
        message.offset, "message D",
        fmt::format("a cycle in {} bytes, {} are expected", message.payload.size(), messageSize()));
  }
  return true;
}

void UlogReader::copy(const UlogMessage& message, CycleRecord& record) const noexcept {
  const char* const fields = message.payload.data() + sizeof(definitions_.cycle_id);
  for (const CopyRun& run : definitions_.topic.runs) {
    std::memcpy(reinterpret_cast<char*>(&record) + run.record_offset, fields + run.message_offset,
                run.size);
  }
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
