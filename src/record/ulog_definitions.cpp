#include "tactus/record/ulog_definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "tactus/record/ulog_format.h"

namespace tactus {
namespace {

/// Far beyond any robot description; what a hostile log may make us hold.
constexpr std::size_t kMaxEmbeddedSize = std::size_t{64} << 20;
/// Memory of an entry, about, besides its text.
constexpr std::size_t kEntrySize = 2 * sizeof(std::string);

template <typename Number>
Number numberAt(std::string_view bytes, std::size_t offset) noexcept {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

/// What informations, multi-informations and parameters are made of.
struct KeyedValue {
  std::string_view type, name, value;

  bool isText() const { return type == fmt::format("char[{}]", value.size()); }
};

class DefinitionsReader {
 public:
  explicit DefinitionsReader(UlogMessages& messages) : messages_(messages) {}

  UlogDefinitions read() {
    readFlagBits();
    do {
      if (!messages_.next(message_)) {
        messages_.fail(messages_.offset(), "definitions",
                       "the log ends here, a subscription of the cycles is expected");
      }
    } while (!readMessage());
    pairUp();
    return std::move(definitions_);
  }

 private:
  [[noreturn]] void fail(std::string_view complaint) const {
    messages_.fail(message_.offset, fmt::format("message {}", message_.type), complaint);
  }

  void readFlagBits() {
    if (!messages_.next(message_) || message_.type != 'B' ||
        message_.payload.size() < kFlagBitsSize) {
      messages_.fail(kUlogHeaderSize, "flag bits", "missing, a message of 40 bytes is expected");
    }
    const std::string_view incompatible = message_.payload.substr(8, 8);
    if (std::any_of(incompatible.begin(), incompatible.end(), [](char c) { return c != 0; })) {
      fail("incompatible flags are set, a log as tactus writes it is expected");
    }
  }

  /// True once the cycles are subscribed.
  bool readMessage() {
    switch (message_.type) {
      case 'F':
        readFormat();
        return false;
      case 'I':
        readInfo();
        return false;
      case 'M':
        readMultiInfo();
        return false;
      case 'P':
        readParameter();
        return false;
      case 'A':
        return readSubscription();
      default:
        messages_.checkIgnorable(message_);
        return false;
    }
  }

  void readFormat() {
    for (int i = 0; i < kSideTopics; ++i)
      if (topicName(message_.payload) == sideTopics()[i].name) return readSideFormat(i);
    if (topicName(message_.payload) != kCycleTopic) return;
    if (has_format_) fail("a second format of the cycles, one is expected");
    const std::string complaint = parseTopicFormat(message_.payload, definitions_.topic);
    if (!complaint.empty()) fail(complaint);
    definitions_.description.shape = definitions_.topic.shape;
    has_format_ = true;
  }

  void readSideFormat(int side) {
    const SideTopic& topic = sideTopics()[side];
    if (has_side_format_[side])
      fail(fmt::format("a second format of {}, one is expected", topic.what));
    const std::string complaint =
        parseSideFormat(topic, message_.payload, definitions_.sides[side].layout);
    if (!complaint.empty()) fail(complaint);
    has_side_format_[side] = true;
  }

  /// `bytes` begin with the key's length.
  KeyedValue parseKeyedValue(std::string_view bytes) const {
    const std::size_t key_size = bytes.empty() ? 0 : static_cast<std::uint8_t>(bytes[0]);
    const std::string_view key = bytes.substr(std::min<std::size_t>(1, bytes.size()), key_size);
    const std::size_t space = key.find(' ');
    if (key.size() < key_size || space == std::string_view::npos || space + 1 == key.size()) {
      fail("no key, a type and a name are expected");
    }
    return {key.substr(0, space), key.substr(space + 1), bytes.substr(1 + key_size)};
  }

  void countEmbedded() {
    embedded_size_ += message_.payload.size() + kEntrySize;
    if (embedded_size_ > kMaxEmbeddedSize) fail("too much text, at most 64 MiB are expected");
  }

  void readInfo() {
    const KeyedValue info = parseKeyedValue(message_.payload);
    if (!info.isText()) return;
    countEmbedded();
    definitions_.description.infos.emplace_back(info.name, info.value);
  }

  void readParameter() {
    const KeyedValue parameter = parseKeyedValue(message_.payload);
    if (parameter.type != "float" || parameter.value.size() != sizeof(float)) {
      fail("no number, a float of 4 bytes is expected");
    }
    countEmbedded();
    definitions_.description.parameters.emplace_back(parameter.name,
                                                     numberAt<float>(parameter.value, 0));
  }

  std::vector<std::string>* multiInfo(std::string_view name) noexcept {
    if (name == kSourcePathKey) return &source_paths_;
    if (name == kSourceTextKey) return &source_texts_;
    if (name == kOverrideKeyKey) return &override_keys_;
    if (name == kOverrideValueKey) return &override_values_;
    return nullptr;
  }

  void readMultiInfo() {
    if (message_.payload.empty()) fail("no content, a continuation flag is expected");
    const bool is_continued = message_.payload[0] != 0;
    const KeyedValue info = parseKeyedValue(message_.payload.substr(1));
    std::vector<std::string>* const texts = multiInfo(info.name);
    if (!texts) return;
    if (!info.isText()) fail("no text, char[] of the value's length is expected");
    countEmbedded();
    if (!is_continued) texts->emplace_back();
    if (texts->empty()) fail("continues nothing, a first part is expected");
    texts->back() += info.value;
  }

  /// None of the topics that are subscribed has it yet.
  void checkId(std::uint16_t id, int own) const {
    for (int i = 0; i < kSideTopics; ++i) {
      const UlogDefinitions::Side& side = definitions_.sides[i];
      if (i != own && side.is_there && side.id == id)
        fail(fmt::format("{} and another topic have one id, two are expected",
                         sideTopics()[i].what));
    }
  }

  bool readSubscription() {
    if (message_.payload.size() < 3) fail("too short, ids and a topic are expected");
    const std::string_view topic = message_.payload.substr(3);
    const auto id = numberAt<std::uint16_t>(message_.payload, 1);
    for (int i = 0; i < kSideTopics; ++i) {
      if (topic != sideTopics()[i].name) continue;
      if (!has_side_format_[i])
        fail(fmt::format("no format of {} came before, one is expected", sideTopics()[i].what));
      checkId(id, i);
      definitions_.sides[i].is_there = true;
      definitions_.sides[i].id = id;
    }
    if (topic != kCycleTopic) return false;
    if (!has_format_) fail("no format of the cycles came before, one is expected");
    checkId(id, kSideTopics);
    definitions_.cycle_id = id;
    return true;
  }

  void pairUp() {
    if (source_paths_.size() != source_texts_.size() ||
        override_keys_.size() != override_values_.size()) {
      fail("sources or overrides are incomplete, pairs are expected");
    }
    LogDescription& description = definitions_.description;
    for (std::size_t i = 0; i < source_paths_.size(); ++i) {
      description.sources.push_back({std::move(source_paths_[i]), std::move(source_texts_[i])});
    }
    for (std::size_t i = 0; i < override_keys_.size(); ++i) {
      description.overrides.push_back(
          {std::move(override_keys_[i]), std::move(override_values_[i])});
    }
  }

  UlogMessages& messages_;
  UlogMessage message_;
  UlogDefinitions definitions_;
  bool has_format_ = false;
  std::array<bool, kSideTopics> has_side_format_{};
  std::vector<std::string> source_paths_, source_texts_, override_keys_, override_values_;
  std::size_t embedded_size_ = 0;
};

}  // namespace

UlogDefinitions readDefinitions(UlogMessages& messages) {
  return DefinitionsReader(messages).read();
}

}  // namespace tactus
