#include "tactus/plant/sdo_server.h"

#include <gtest/gtest.h>

#include <optional>

#include "plant/can_bytes.h"
#include "support/random.h"

/// Frames as CiA 301 prints them: byte 0 command, 1-2 index, 3 subindex, 4-7 data.
namespace tactus {
namespace {

using test::canFrame;
using test::number;

class SdoServer : public testing::Test {
 protected:
  CanFrame ask(const CanFrame& request) {
    CanFrame response;
    EXPECT_TRUE(answerSdo(request, objects_, response));
    EXPECT_EQ(response.size, 8);
    for (int i = 1; i <= 3; ++i) EXPECT_EQ(response.data[i], request.data[i]) << "other object";
    return response;
  }

  /// The abort code, 0 if there was none.
  std::uint32_t write(int index, int subindex, std::uint32_t value, int size) {
    const CanFrame response =
        ask(canFrame(0x601, {0x23 | (4 - size) << 2, index & 0xFF, index >> 8, subindex,
                             static_cast<int>(value & 0xFF), static_cast<int>(value >> 8 & 0xFF),
                             static_cast<int>(value >> 16 & 0xFF), static_cast<int>(value >> 24)}));
    if (response.data[0] == 0x60) return 0;
    EXPECT_EQ(response.data[0], 0x80);
    return number(response, 4, 4);
  }

  std::uint32_t read(int index, int subindex) {
    const CanFrame response =
        ask(canFrame(0x601, {0x40, index & 0xFF, index >> 8, subindex, 0, 0, 0, 0}));
    EXPECT_EQ(response.data[0] & 0xE3, 0x43) << "no expedited answer with size";
    const int bytes = 4 - ((response.data[0] >> 2) & 3);
    for (int i = bytes; i < 4; ++i) EXPECT_EQ(response.data[4 + i], 0);
    return number(response, 4, bytes);
  }

  /// What a master does to set up a drive's PDOs.
  void mapPdo(int communication, int mapping, std::uint32_t cob_id,
              std::initializer_list<std::uint32_t> entries) {
    EXPECT_EQ(write(communication, 1, 0x8000'0000U | cob_id, 4), 0u);
    EXPECT_EQ(write(mapping, 0, 0, 1), 0u);
    int i = 0;
    for (const std::uint32_t entry : entries) EXPECT_EQ(write(mapping, ++i, entry, 4), 0u);
    EXPECT_EQ(write(mapping, 0, static_cast<std::uint32_t>(i), 1), 0u);
    EXPECT_EQ(write(communication, 2, 1, 1), 0u);
    EXPECT_EQ(write(communication, 1, cob_id, 4), 0u);
  }

  ObjectDictionary objects_{1};
};

TEST_F(SdoServer, AnswersUploadsByteForByte) {
  CanFrame response = ask(canFrame(0x601, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(response.data, (decltype(CanFrame::data){0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0}));
  response = ask(canFrame(0x601, {0x40, 0x5A, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(response.data, (decltype(CanFrame::data){0x4B, 0x5A, 0x60, 0, 2, 0, 0, 0}));
  response = ask(canFrame(0x601, {0x40, 0x18, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(response.data, (decltype(CanFrame::data){0x4F, 0x18, 0x10, 0, 4, 0, 0, 0}));
}

TEST_F(SdoServer, AnswersDownloadsByteForByte) {
  CanFrame response = ask(canFrame(0x601, {0x2F, 0x60, 0x60, 0, 9, 0, 0, 0}));
  EXPECT_EQ(response.data, (decltype(CanFrame::data){0x60, 0x60, 0x60, 0, 0, 0, 0, 0}));
  EXPECT_EQ(read(0x6060, 0), 9u);
  response = ask(canFrame(0x601, {0x2B, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0}));
  EXPECT_EQ(response.data[0], 0x60);
  EXPECT_EQ(read(0x1017, 0), 1000u);
  // Size not indicated: the object's own counts.
  response = ask(canFrame(0x601, {0x22, 0x17, 0x10, 0, 0x14, 0x00, 0xFF, 0xFF}));
  EXPECT_EQ(response.data[0], 0x60);
  EXPECT_EQ(read(0x1017, 0), 20u);
}

TEST_F(SdoServer, AbortsWithTheCodesOfTheStandard) {
  EXPECT_EQ(write(0x2000, 0, 1, 4), 0x0602'0000u);
  EXPECT_EQ(write(0x1017, 7, 1, 2), 0x0609'0011u);
  EXPECT_EQ(write(0x6041, 0, 1, 2), 0x0601'0002u);
  EXPECT_EQ(write(0x1000, 0, 1, 4), 0x0601'0002u);
  EXPECT_EQ(write(0x1017, 0, 1, 4), 0x0607'0012u);
  EXPECT_EQ(write(0x60FF, 0, 1, 2), 0x0607'0013u);
  EXPECT_EQ(write(0x6060, 0, 8, 1), 0x0609'0030u);
  EXPECT_EQ(write(0x6060, 0, 9, 1), 0u);
  EXPECT_EQ(write(0x60C2, 1, 0, 1), 0x0609'0030u);
  EXPECT_EQ(write(0x60C2, 2, 0xFD, 1), 0u);
  EXPECT_EQ(write(0x60C2, 2, 3, 1), 0x0609'0030u);
  EXPECT_EQ(write(0x605A, 0, 5, 2), 0x0609'0030u);
  CanFrame response = ask(canFrame(0x601, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}));
  EXPECT_EQ(response.data, (decltype(CanFrame::data){0x80, 0, 0x20, 0, 0, 0, 2, 6}));
  response = ask(canFrame(0x601, {0x21, 0x17, 0x10, 0, 2, 0, 0, 0}));  // segmented
  EXPECT_EQ(number(response, 4, 4), 0x0504'0001u);
  response = ask(canFrame(0x601, {0x60, 0x17, 0x10, 0, 0, 0, 0, 0}));
  EXPECT_EQ(number(response, 4, 4), 0x0504'0001u);
}

TEST_F(SdoServer, StaysSilentOnAbortsAndShortFrames) {
  CanFrame response;
  EXPECT_FALSE(answerSdo(canFrame(0x601, {0x80, 0x17, 0x10, 0, 0, 0, 4, 5}), objects_, response));
  EXPECT_FALSE(answerSdo(canFrame(0x601, {0x40, 0x17, 0x10, 0}), objects_, response));
}

TEST_F(SdoServer, MapsPdosInTheOrderOfTheStandard) {
  mapPdo(0x1400, 0x1600, 0x201, {0x6040'0010, 0x60FF'0020});
  mapPdo(0x1800, 0x1A00, 0x181, {0x6041'0010, 0x6064'0020});
  EXPECT_EQ(read(0x1600, 0), 2u);
  EXPECT_EQ(read(0x1A00, 2), 0x6064'0020u);
  EXPECT_EQ(read(0x1400, 1), 0x201u);
}

TEST_F(SdoServer, HasAnEventTimerForTheReceivePdoOnly) {
  EXPECT_EQ(read(0x1400, 0), 5u);
  EXPECT_EQ(read(0x1400, 5), 0u);
  for (const std::uint32_t ms : {60U, 250U, 65535U, 0U}) {
    EXPECT_EQ(write(0x1400, 5, ms, 2), 0u);
    EXPECT_EQ(read(0x1400, 5), ms);
  }
  EXPECT_EQ(write(0x1400, 5, 60, 4), 0x0607'0012u);
  for (const int subindex : {3, 4, 6}) EXPECT_EQ(write(0x1400, subindex, 1, 1), 0x0609'0011u);
  EXPECT_EQ(write(0x1800, 5, 60, 2), 0x0609'0011u);
}

TEST_F(SdoServer, RefusesMappingsInAnyOtherOrder) {
  EXPECT_EQ(write(0x1600, 0, 0, 1), 0x0800'0022u) << "the PDO is valid";
  EXPECT_EQ(write(0x1600, 1, 0x60FF'0020, 4), 0x0800'0022u);
  EXPECT_EQ(write(0x1400, 1, 0x202, 4), 0x0800'0022u) << "another id while valid";
  EXPECT_EQ(write(0x1400, 1, 0x8000'0201, 4), 0u);
  EXPECT_EQ(write(0x1600, 1, 0x60FF'0020, 4), 0x0601'0000u) << "entries while there are any";
  EXPECT_EQ(write(0x1600, 0, 0, 1), 0u);
  EXPECT_EQ(write(0x1600, 1, 0x6064'0020, 4), 0x0604'0041u) << "a drive does not take its position";
  EXPECT_EQ(write(0x1600, 1, 0x60FF'0010, 4), 0x0604'0041u) << "not as long as that";
  EXPECT_EQ(write(0x1600, 1, 0x2000'0020, 4), 0x0604'0041u);
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(write(0x1600, i, 0x60FF'0020, 4), 0u);
  EXPECT_EQ(write(0x1600, 0, 3, 1), 0x0604'0042u) << "twelve bytes";
  EXPECT_EQ(write(0x1600, 0, 9, 1), 0x0609'0030u);
  EXPECT_EQ(write(0x1600, 0, 4, 1), 0x0604'0041u) << "the fourth is empty";
  EXPECT_EQ(write(0x1600, 0, 2, 1), 0u);
  EXPECT_EQ(write(0x1400, 1, 0x601, 4), 0x0609'0030u) << "an id of the SDO";
  EXPECT_EQ(write(0x1400, 1, 0x2000'0201, 4), 0x0609'0030u) << "29 bits";
  EXPECT_EQ(write(0x1400, 2, 250, 1), 0x0609'0030u);
}

TEST_F(SdoServer, SurvivesAnyFrameAndKeepsToItsRanges) {
  test::Random random(821);
  for (int i = 0; i < 300000; ++i) {
    CanFrame request = canFrame(0x601, {});
    request.size = random.chance(0.95) ? 8 : static_cast<std::uint8_t>(random.index(8));
    for (std::uint8_t& byte : request.data) byte = static_cast<std::uint8_t>(random.index(256));
    if (random.chance(0.9)) {  // near what exists
      constexpr std::array<int, 12> kIndices = {0x1005, 0x1016, 0x1017, 0x1400, 0x1600, 0x1800,
                                                0x1A00, 0x6040, 0x6060, 0x6085, 0x60C2, 0x60FF};
      const int index = kIndices[random.index(12)];
      request.data[1] = static_cast<std::uint8_t>(index);
      request.data[2] = static_cast<std::uint8_t>(index >> 8);
      request.data[3] = static_cast<std::uint8_t>(random.index(10));
      if (random.chance(0.7)) request.data[0] = random.chance(0.8) ? 0x22 : 0x40;
      if (random.chance(0.5)) request.data[4] = static_cast<std::uint8_t>(random.index(10));
      if (random.chance(0.5)) request.data[7] = random.chance(0.5) ? 0x80 : 0x00;
    }
    CanFrame response;
    answerSdo(request, objects_, response);
  }
  EXPECT_LE(objects_.get(0x1600), 8u);
  EXPECT_TRUE(objects_.get(0x6060) == 0 || objects_.get(0x6060) == 9);
  EXPECT_GT(objects_.get(0x60C2, 1), 0u);
}

}  // namespace
}  // namespace tactus
