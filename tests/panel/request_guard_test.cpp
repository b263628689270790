#include "tactus/panel/request_guard.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace tactus {
namespace {

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

RequestHead writeOfThePage() {
  RequestHead head;
  head.method = "POST";
  head.path = kWritePath;
  head.hosts = {"127.0.0.1:8470"};
  head.origins = {"http://127.0.0.1:8470"};
  head.lengths = {"20"};
  head.tokens = {kToken};
  head.fetch_site = "same-origin";
  head.content_type = "application/json";
  return head;
}

int senderStatus(const RequestHead& head) {
  const auto refusal = senderRefusal(head, kToken);
  return refusal ? refusal->status : 200;
}

int bodyStatus(const RequestHead& head) {
  const auto refusal = bodyRefusal(head);
  return refusal ? refusal->status : 200;
}

TEST(RequestGuardTest, LetsThePageWrite) {
  EXPECT_EQ(bodyStatus(writeOfThePage()), 200);
  EXPECT_EQ(senderStatus(writeOfThePage()), 200);
}

TEST(RequestGuardTest, KnowsThisMachineByItsNamesAlone) {
  for (const char* host : {"127.0.0.1", "localhost", "LOCALHOST:1", "[::1]", "[::1]:65535"})
    EXPECT_TRUE(isLoopbackHost(host)) << host;
  for (const char* host :
       {"", ":", ":80", "localhost:", "localhost:1a", "localhost:123456", "localhost.",
        "localhost.evil", "evil.localhost", "127.0.0.1.evil", "127.0.0.2", "0.0.0.0", "[::1", "::1",
        "[::1]x", "127.0.0.1 ", "localhost:80:80", "evil@127.0.0.1"})
    EXPECT_FALSE(isLoopbackHost(host)) << host;
}

TEST(RequestGuardTest, RefusesStrangersWhateverTheyBring) {
  RequestHead head = writeOfThePage();
  head.hosts = {"evil.example"};
  head.origins = {"http://evil.example"};
  EXPECT_EQ(senderStatus(head), 403);
  head = writeOfThePage();
  head.hosts.push_back("127.0.0.1:8470");
  EXPECT_EQ(senderStatus(head), 403);
  head = writeOfThePage();
  head.origins.push_back("http://127.0.0.1:8470");
  EXPECT_EQ(senderStatus(head), 403);
  for (const char* origin :
       {"", "null", "http://localhost:8470", "http://127.0.0.1", "https://127.0.0.1:8470"}) {
    head = writeOfThePage();
    head.origins = {origin};
    EXPECT_EQ(senderStatus(head), 403) << origin;
  }
  head = writeOfThePage();
  head.fetch_site = "cross-site";
  EXPECT_EQ(senderStatus(head), 403);
  head.path = "/";  // a link
  EXPECT_EQ(senderStatus(head), 200);
}

TEST(RequestGuardTest, AsksForTheTokenOfWritesAlone) {
  RequestHead head = writeOfThePage();
  head.tokens.clear();
  EXPECT_EQ(senderStatus(head), 401);
  head.tokens = {kToken, kToken};
  EXPECT_EQ(senderStatus(head), 401);
  head.tokens.clear();
  head.path = "/api/check";
  EXPECT_EQ(senderStatus(head), 200);
}

TEST(RequestGuardTest, ComparesTokensAsTextsAreCompared) {
  std::mt19937 random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string token(1 + random() % 4, 'a'), given(random() % 6, 'a');
    for (char& c : token) c = static_cast<char>('a' + random() % 2);
    for (char& c : given) c = static_cast<char>('a' + random() % 2);
    ASSERT_EQ(isSameToken(given, token), given == token) << given << " " << token;
  }
  EXPECT_FALSE(isSameToken("", ""));  // no token is no permission
  EXPECT_FALSE(isSameToken(std::string(1 << 20, 'a'), "a"));
}

TEST(RequestGuardTest, RefusesBodiesThatCannotBeReadSafely) {
  const auto with = [](auto&& change) {
    RequestHead head = writeOfThePage();
    change(head);
    return bodyStatus(head);
  };
  EXPECT_EQ(with([](RequestHead& head) { head.lengths = {"16384"}; }), 200);
  EXPECT_EQ(with([](RequestHead& head) { head.lengths = {"16385"}; }), 413);
  EXPECT_EQ(with([](RequestHead& head) { head.lengths = {}; }), 411);
  for (const char* length : {"", "-1", "+1", " 1", "1 ", "0x10", "1,1", "99999999999999999999999"})
    EXPECT_EQ(with([&](RequestHead& head) { head.lengths = {length}; }), 400) << length;
  EXPECT_EQ(with([](RequestHead& head) { head.lengths = {"1", "1"}; }), 400);
  EXPECT_EQ(with([](RequestHead& head) { head.is_encoded = true; }), 415);
  EXPECT_EQ(with([](RequestHead& head) { head.is_partial = true; }), 416);
  EXPECT_EQ(with([](RequestHead& head) { head.method = "GET"; }), 400);
  EXPECT_EQ(with([](RequestHead& head) { head.method = "PUT"; }), 405);
  for (const char* type :
       {"", "text/plain", "application/json2", "application/x-www-form-urlencoded"})
    EXPECT_EQ(with([&](RequestHead& head) { head.content_type = type; }), 415) << type;
  EXPECT_EQ(with([](RequestHead& head) { head.content_type = "application/JSON;charset=utf-8"; }),
            200);
}

TEST(RequestGuardTest, MakesTokensThatDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(makeToken());
  EXPECT_EQ(tokens.size(), 100u);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32u);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

}  // namespace
}  // namespace tactus
