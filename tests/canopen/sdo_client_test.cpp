#include "tactus/canopen/sdo_client.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "support/allocation_guard.h"
#include "support/random.h"
#include "support/scripted_drive.h"
#include "tactus/canopen/sdo_abort.h"

namespace tactus {
namespace {

using test::rawFrame;

constexpr int kTimeout = 20;
constexpr ObjectEntry kControlWord{0x6040, 0, 2};
constexpr ObjectEntry kDeviceType{0x1000, 0, 4};

class Sdo : public testing::Test {
 protected:
  std::vector<CanFrame> update() {
    FrameBatch out;
    client.update(out);
    return {out.begin(), out.end()};
  }
  void hear(const std::vector<int>& bytes, std::uint32_t id = 0x585) {
    client.receive(rawFrame(id, bytes));
  }

  /// An upload of 1000:00 or a download to 6040:00 whose request has been sent.
  void beginUpload() {
    client.upload(kDeviceType);
    ASSERT_EQ(update(), (std::vector{rawFrame(0x605, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0})}));
  }
  void beginDownload() {
    client.download(kControlWord, 0x000F);
    ASSERT_EQ(update(), (std::vector{rawFrame(0x605, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0})}));
  }

  void expectRefusal(std::uint32_t code) {
    EXPECT_EQ(client.status(), SdoStatus::kAborted);
    EXPECT_EQ(client.abortCode(), code) << sdoAbortName(client.abortCode());
    const auto sent = update();
    ASSERT_EQ(sent.size(), 1u) << "the server has to be told";
    EXPECT_EQ(sent[0].id, 0x605u);
    EXPECT_EQ(sent[0].data[0], 0x80);
    EXPECT_EQ(
        sent[0].data[4] | sent[0].data[5] << 8 | sent[0].data[6] << 16 | sent[0].data[7] << 24,
        static_cast<int>(code));
    EXPECT_TRUE(update().empty());
  }

  SdoClient client{5, kTimeout};
};

TEST_F(Sdo, DownloadsOneToFourBytes) {
  const int commands[] = {0x2F, 0x2B, 0x27, 0x23};
  for (int size = 1; size <= 4; ++size) {
    client.download({0x1A2B, 0x3C, size}, 0xF4F3F2F1);
    std::vector<int> bytes = {commands[size - 1], 0x2B, 0x1A, 0x3C, 0, 0, 0, 0};
    for (int i = 0; i < size; ++i) bytes[4 + i] = 0xF1 + i;
    EXPECT_EQ(update(), (std::vector{rawFrame(0x605, bytes)}));
    EXPECT_EQ(client.status(), SdoStatus::kBusy);
    hear({0x60, 0x2B, 0x1A, 0x3C, 0, 0, 0, 0});
    EXPECT_EQ(client.status(), SdoStatus::kDone);
    EXPECT_TRUE(update().empty());
  }
}

TEST_F(Sdo, UploadsOneToFourBytes) {
  const int commands[] = {0x4F, 0x4B, 0x47, 0x43};
  const std::uint32_t values[] = {0xF1, 0xF2F1, 0xF3F2F1, 0xF4F3F2F1};
  for (int size = 1; size <= 4; ++size) {
    client.upload({0x6061, 0, size});
    EXPECT_EQ(update(), (std::vector{rawFrame(0x605, {0x40, 0x61, 0x60, 0, 0, 0, 0, 0})}));
    hear({commands[size - 1], 0x61, 0x60, 0, 0xF1, 0xF2, 0xF3, 0xF4});
    EXPECT_EQ(client.status(), SdoStatus::kDone);
    EXPECT_EQ(client.value(), values[size - 1]);
  }
}

TEST_F(Sdo, TakesAnUploadWithoutSizeAsTheEntrys) {
  client.upload({0x6061, 0, 2});
  update();
  hear({0x42, 0x61, 0x60, 0, 0xF1, 0xF2, 0xF3, 0xF4});
  EXPECT_EQ(client.status(), SdoStatus::kDone);
  EXPECT_EQ(client.value(), 0xF2F1u);
}

TEST_F(Sdo, ReportsTheServersAbort) {
  beginDownload();
  hear({0x80, 0x40, 0x60, 0, 0x22, 0x00, 0x00, 0x08});
  EXPECT_EQ(client.status(), SdoStatus::kAborted);
  EXPECT_EQ(client.abortCode(), 0x08000022u);
  EXPECT_TRUE(update().empty()) << "an abort is not answered";
}

TEST_F(Sdo, IgnoresWhatIsNotItsAnswer) {
  beginUpload();
  const std::vector<int> good = {0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00};
  for (std::uint32_t id : {0x584u, 0x586u, 0x605u, 0x185u, 0x005u}) hear(good, id);
  hear({0x43, 0x00, 0x10, 1, 1, 2, 3, 4});  // another subindex
  hear({0x43, 0x01, 0x10, 0, 1, 2, 3, 4});  // another index
  hear({0x43, 0x00, 0x11, 0, 1, 2, 3, 4});
  hear({0x60, 0x40, 0x60, 0, 0, 0, 0, 0});  // late, of an earlier download
  hear({0x80, 0x40, 0x60, 0, 0, 0, 0, 8});
  for (int size = 0; size < 8; ++size) hear(std::vector<int>(good.begin(), good.begin() + size));
  CanFrame frame = rawFrame(0x585, good);
  frame.extended = true;
  client.receive(frame);
  frame.extended = false;
  frame.kind = FrameKind::kRemote;
  client.receive(frame);
  EXPECT_EQ(client.status(), SdoStatus::kBusy);
  EXPECT_TRUE(update().empty());
  hear(good);
  EXPECT_EQ(client.status(), SdoStatus::kDone);
  EXPECT_EQ(client.value(), 0x00020192u);
}

TEST_F(Sdo, IgnoresAnswersWhenIdle) {
  for (int command = 0; command < 256; ++command) hear({command, 0x00, 0x10, 0, 1, 2, 3, 4});
  EXPECT_EQ(client.status(), SdoStatus::kIdle);
  EXPECT_TRUE(update().empty());
  beginDownload();
  hear({0x60, 0x40, 0x60, 0, 0, 0, 0, 0});
  hear({0x80, 0x40, 0x60, 0, 0, 0, 0, 8});
  EXPECT_EQ(client.status(), SdoStatus::kDone) << "it was over";
}

TEST_F(Sdo, IgnoresAnswersBeforeItHasAsked) {
  client.download(kControlWord, 6);
  hear({0x60, 0x40, 0x60, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.status(), SdoStatus::kBusy);
}

TEST_F(Sdo, RefusesSegmentedAnswers) {
  beginUpload();
  hear({0x41, 0x00, 0x10, 0, 20, 0, 0, 0});
  expectRefusal(0x06070010);
}

TEST_F(Sdo, RefusesDataOfAnotherLength) {
  client.upload({0x1000, 0, 2});
  update();
  hear({0x43, 0x00, 0x10, 0, 1, 2, 3, 4});
  expectRefusal(0x06070012);
  beginUpload();
  hear({0x4F, 0x00, 0x10, 0, 1, 0, 0, 0});
  expectRefusal(0x06070013);
}

/// Late, where an entry that was being written is read again.
TEST_F(Sdo, IgnoresAnswersOfTheOtherDirection) {
  beginDownload();
  hear({0x4B, 0x40, 0x60, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.status(), SdoStatus::kBusy);
  beginUpload();
  hear({0x60, 0x00, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.status(), SdoStatus::kBusy);
  EXPECT_TRUE(update().empty());
  hear({0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00});
  EXPECT_EQ(client.status(), SdoStatus::kDone);
}

TEST_F(Sdo, RefusesSegmentsAndBlocks) {
  for (int specifier : {0, 1, 5, 6, 7}) {  // segment up, segment down, block, unknown
    for (int rest : {0x00, 0x10, 0x1F}) {  // both toggle bits
      beginDownload();
      hear({specifier << 5 | rest, 0x40, 0x60, 0, 0, 0, 0, 0});
      expectRefusal(0x05040001);
    }
  }
}

TEST_F(Sdo, GivesUpAfterItsCyclesAndTellsTheServer) {
  beginUpload();
  for (int cycle = 1; cycle < kTimeout; ++cycle) {
    ASSERT_TRUE(update().empty()) << cycle;
    ASSERT_EQ(client.status(), SdoStatus::kBusy) << cycle;
  }
  EXPECT_EQ(update(),
            (std::vector{rawFrame(0x605, {0x80, 0x00, 0x10, 0, 0x00, 0x00, 0x04, 0x05})}));
  EXPECT_EQ(client.status(), SdoStatus::kTimedOut);
  hear({0x43, 0x00, 0x10, 0, 1, 2, 3, 4});
  EXPECT_EQ(client.status(), SdoStatus::kTimedOut) << "too late";
  EXPECT_TRUE(update().empty());
}

TEST_F(Sdo, CanBeUsedAgainAfterEveryEnd) {
  beginUpload();
  for (int cycle = 0; cycle < kTimeout; ++cycle) update();
  beginUpload();
  hear({0x80, 0x00, 0x10, 0, 0, 0, 0, 8});
  EXPECT_NE(client.abortCode(), 0u);
  beginDownload();
  EXPECT_EQ(client.abortCode(), 0u) << "of what is asked for now";
  hear({0x60, 0x40, 0x60, 0, 0, 0, 0, 0});
  EXPECT_EQ(client.status(), SdoStatus::kDone);
}

/// Whatever comes, it sends at most one frame a cycle and ends in time.
TEST_F(Sdo, EndsWhateverComes) {
  test::Random random(402);
  for (int run = 0; run < 3000; ++run) {
    const bool is_upload = random.chance(0.5);
    const ObjectEntry entry{0x6061, 0, random.integer(1, 4)};
    if (is_upload) client.upload(entry);
    if (!is_upload) client.download(entry, 1);
    int cycle = 0;
    for (; cycle <= kTimeout && client.status() == SdoStatus::kBusy; ++cycle) {
      test::AllocationGuard guard;
      FrameBatch out;
      client.update(out);
      ASSERT_LE(out.size(), 1u);
      CanFrame frame;
      frame.id = 0x585;
      frame.size = 8;
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random.index(256));
      if (random.chance(0.9)) frame.data = {frame.data[0], 0x61, 0x60, 0, 1, 2, 3, 4};
      if (random.chance(0.2)) client.receive(frame);
    }
    ASSERT_NE(client.status(), SdoStatus::kBusy);
    if (client.status() == SdoStatus::kDone && is_upload) {
      ASSERT_EQ(client.value(), 0x04030201u & (0xFFFFFFFFu >> (32 - 8 * entry.size)));
    }
    update();
  }
}

TEST(SdoAbort, NamesEveryCodeOnce) {
  std::set<std::uint32_t> codes;
  std::set<std::string> names;
  for (const SdoAbortRow& row : sdoAbortTable()) {
    EXPECT_TRUE(codes.insert(row.code).second);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(std::string(sdoAbortName(row.code)), row.name);
  }
  EXPECT_STREQ(sdoAbortName(0x06090030), "invalid value");
  EXPECT_STREQ(sdoAbortName(0x06020000), "object does not exist");
  EXPECT_STREQ(sdoAbortName(0x12345678), "unknown abort code");
}

}  // namespace
}  // namespace tactus
