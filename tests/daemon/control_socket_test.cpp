#include "tactus/daemon/control_socket.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "tactus/daemon/control_client.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

class ControlSocketTest : public testing::Test {
 protected:
  static int connect(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, path.size());
    const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    return fd;
  }

  const test::RunFolder folder_;
  const Scene scene_ = test::shippedScene("commands");
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
};

TEST_F(ControlSocketTest, AnswersAndHandsOn) {
  const ControlSocket socket(scene_, *link_);
  struct stat status {};
  ASSERT_EQ(::stat(controlPath().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0660u);
  const ControlClient client(controlPath());
  EXPECT_EQ(client.ask({{"do", "show"}}).at("state"), "kept");
  // Of all orders the one that takes no time to check.
  ToolSight sight;
  sight.is_running = true;
  link_->tool_sights.put(sight);
  client.ask({{"do", "hold"}});
  ToolOrder order;
  ASSERT_TRUE(link_->tool_orders.pop(order));
  EXPECT_EQ(order.kind, ToolOrder::Kind::kHold);
  EXPECT_THROW(client.ask({{"do", "jump"}}), InputError);
}

TEST_F(ControlSocketTest, IsGoneWithTheDaemon) {
  { const ControlSocket socket(scene_, *link_); }
  EXPECT_FALSE(folder_.has(kControlName));
  EXPECT_THROW(ControlClient{controlPath()}, RunError);
}

TEST_F(ControlSocketTest, OutlivesHostileClients) {
  const ControlSocket socket(scene_, *link_);
  std::vector<int> clients;
  const std::string flood(40000, '{');
  for (int i = 0; i < 40; ++i) {
    clients.push_back(connect(controlPath()));
    ::send(clients.back(), flood.data(), i % 2 == 0 ? flood.size() : 100, MSG_NOSIGNAL);
    for (int k = 0; k < 20; ++k) ::send(clients.back(), "{}", 2, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (i % 3 == 0) ::close(clients.back());
  }
  for (std::size_t i = 0; i < clients.size(); ++i)
    if (i % 3 != 0) ::close(clients[i]);
  // Their places are free once the daemon has seen that they left.
  for (int attempt = 0;; ++attempt) {
    try {
      const ControlClient client(controlPath());
      EXPECT_EQ(client.ask({{"do", "show"}}).at("done"), true);
      break;
    } catch (const std::exception& error) {
      ASSERT_LT(attempt, 200) << error.what();
      ::usleep(20'000);
    }
  }
}

TEST_F(ControlSocketTest, DoesNotExistWithoutAFolder) {
  unsetenv("RUNTIME_DIRECTORY");
  const ControlSocket socket(scene_, *link_);
  EXPECT_FALSE(folder_.has(kControlName));
}

}  // namespace
}  // namespace tactus
