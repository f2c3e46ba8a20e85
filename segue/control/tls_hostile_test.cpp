// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/rpc/detail/server_core.hpp>
#include <support/eventually.hpp>
#include <support/sanitizers.hpp>
#include <support/secure_server.hpp>

#include <atomic>
#include <fstream>
#include <future>
#include <memory>
#include <random>
#include <thread>
#include <vector>

namespace segue::control {
namespace {

/// How much more memory a test may take; sanitizers keep what has been freed.
constexpr std::size_t kMostMemory = std::size_t{kSanitized ? 800 : 60} << 20;

std::string random_bytes(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(size, '\0');
  for (char& byte : bytes)
    byte = static_cast<char>(random());
  return bytes;
}

/// Of this process, in bytes.
std::size_t resident_memory() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0;
  std::size_t resident = 0;
  file >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST_F(SecureTest, PlainTextInsteadOfTlsIsRefused) {
  serve_tcp();
  const auto good = client_of("ann");
  for (const std::string& text : {std::string("GET / HTTP/1.1\r\n\r\n"), bootstrap_message(0)}) {
    Raw plain(server_->port());
    plain.send(text);
    EXPECT_TRUE(plain.is_closed());
  }
  EXPECT_TRUE(log_->has({"refused a client without a name at 127.0.0.1:", "does not speak TLS"}));
  EXPECT_TRUE(good->status());
}

TEST_F(SecureTest, GarbageInsteadOfAHandshakeIsRefused) {
  serve_tcp();
  const auto good = client_of("ann");
  for (unsigned round = 0; round < 20; ++round) {
    Raw hostile(server_->port());
    // Half of it claims to be a record of a handshake.
    hostile.send((round % 2 == 0 ? std::string("\x16\x03\x01\x02\x00", 5) : std::string()) +
                 random_bytes(4096, round));
    EXPECT_TRUE(hostile.is_closed()) << round;
    EXPECT_TRUE(good->status()) << round;
  }
  EXPECT_TRUE(log_->has({"refused a client without a name at 127.0.0.1:"}));
}

TEST_F(SecureTest, GarbageAfterTheHandshakeEndsThatConnectionOnly) {
  serve_tcp();
  const auto good = client_of("ann");
  RawTls outside(server_->port(), enrolled_, "ann");
  outside.send_unencrypted(std::string("\x17\x03\x03\x10\x00", 5) + random_bytes(4096, 1));
  EXPECT_TRUE(outside.is_closed());
  RawTls inside(server_->port(), enrolled_, "ann");
  std::string garbage = random_bytes(4096, 2);
  for (char& byte : garbage)
    byte = static_cast<char>(static_cast<unsigned char>(byte) | 0x80U);
  inside.send(garbage);
  EXPECT_TRUE(inside.is_closed());
  EXPECT_TRUE(
      log_->has({"refused 'ann' (operate) at 127.0.0.1:", "the TLS connection with the client failed"}));
  EXPECT_TRUE(log_->has({"refused 'ann' (operate) at 127.0.0.1:", "not a message, or too large a one"}));
  EXPECT_TRUE(good->status());
}

TEST_F(SecureTest, AMessageThatClaimsToBeHugeIsRefusedBeforeItIsSent) {
  serve_tcp();
  const auto good = client_of("ann");
  RawTls one_segment(server_->port(), enrolled_, "ann");
  one_segment.send(word(0, 0x10000000));  // 2 GiB
  EXPECT_TRUE(one_segment.is_closed());
  EXPECT_TRUE(log_->has({"refused 'ann' (operate) at 127.0.0.1:", "too large a one"}));
  EXPECT_TRUE(good->status());
}

TEST_F(SecureTest, AnEndlessMessageTakesNoMemory) {
  serve_tcp();
  const auto good = client_of("ann");
  const std::size_t before = resident_memory();
  RawTls endless(server_->port(), enrolled_, "ann");
  endless.send(word(0, 0x000FFFFF));  // 8 MiB, the largest that is allowed
  const std::string megabyte(std::size_t{1} << 20, 'x');
  std::size_t sent = 0;
  for (std::size_t now = megabyte.size(); now == megabyte.size() && sent < (std::size_t{256} << 20);) {
    now = endless.send(megabyte);
    sent += now;
  }
  EXPECT_LT(sent, std::size_t{128} << 20);
  EXPECT_TRUE(endless.is_closed());
  EXPECT_TRUE(good->status());
  EXPECT_LT(resident_memory(), before + kMostMemory);
}

/// Passes one connection on and keeps what the client sent.
class Recorder {
 public:
  explicit Recorder(std::uint16_t port)
      : listening_(detail::listen_tcp({"127.0.0.1", 0}).value()), thread_([this, port] { pump(port); }) {}
  ~Recorder() { thread_.join(); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;
  [[nodiscard]] std::uint16_t port() const { return detail::port_of(listening_.get()); }
  /// After the client has closed.
  std::string recorded() {
    thread_.join();
    thread_ = std::thread([] {});
    return sent_;
  }

 private:
  static std::string read_from(int socket) {
    std::string bytes(65536, '\0');
    const auto got = ::recv(socket, bytes.data(), bytes.size(), 0);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

  void pump(std::uint16_t port) {
    pollfd waiting{listening_.get(), POLLIN, 0};
    ::poll(&waiting, 1, 20'000);
    const Descriptor client(::accept(listening_.get(), nullptr, nullptr));
    const Descriptor server = detail::connect_tcp({"127.0.0.1", port}, soon()).value();
    for (;;) {
      pollfd entries[2] = {{client.get(), POLLIN, 0}, {server.get(), POLLIN, 0}};
      if (::poll(entries, 2, 20'000) <= 0) return;
      const bool from_client = entries[0].revents != 0;
      const std::string bytes = read_from(from_client ? client.get() : server.get());
      if (bytes.empty()) return;
      if (from_client) sent_ += bytes;
      ::send(from_client ? server.get() : client.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    }
  }

  Descriptor listening_;
  std::string sent_;
  std::thread thread_;
};

TEST_F(SecureTest, BytesOfAFormerConnectionOpenNothing) {
  serve_tcp();
  Recorder recorder(server_->port());
  auto through = endpoint("ann");
  through.address.port = recorder.port();
  {
    const auto robot = connect(through, kLong).value();
    ASSERT_TRUE(robot->shut_down());
  }
  robot_.asked_to_end = false;
  const std::string recorded = recorder.recorded();
  ASSERT_GT(recorded.size(), 1000U);
  Raw again(server_->port());
  again.send(recorded);
  EXPECT_TRUE(again.is_closed());
  EXPECT_FALSE(robot_.asked_to_end);
  EXPECT_TRUE(log_->has({"refused a client without a name at 127.0.0.1:"}));
  EXPECT_TRUE(client_of("ann")->status());
}

TEST_F(SecureTest, AThousandHalfOpenConnectionsKeepNobodyOut) {
  serve_tcp();
  const auto good = client_of("ann");
  const std::size_t before = resident_memory();
  std::vector<std::unique_ptr<Raw>> crowd;
  while (crowd.size() < 1000) {
    crowd.push_back(std::make_unique<Raw>(server_->port()));
    crowd.back()->send(std::string("\x16\x03\x01\x02\x00\x01", 6));  // the begin of a handshake
    if (crowd.size() % 100 == 0) {
      EXPECT_TRUE(good->status());
      EXPECT_TRUE(client_of("ann")->status());
    }
  }
  EXPECT_TRUE(crowd.front()->is_closed()) << "the oldest one";
  EXPECT_TRUE(good->status());
  EXPECT_LT(resident_memory(), before + kMostMemory);
  EXPECT_TRUE(log_->has({"more refusals were not logged"}));
  EXPECT_LT(log_->count(), 200U) << "a flood is not logged line by line";
}

TEST_F(SecureTest, WhoHasShownACertificateGoesAfterThoseWhoHaveNot) {
  serve_tcp();
  RawTls known(server_->port(), enrolled_, "ann");
  EXPECT_TRUE(client_of("ann")->status()) << "the server has the certificates of both";
  std::vector<std::unique_ptr<Raw>> crowd;
  while (crowd.size() < 100)
    crowd.push_back(std::make_unique<Raw>(server_->port()));
  EXPECT_TRUE(crowd.front()->is_closed()) << "the oldest one without";
  EXPECT_TRUE(known.is_closed());
  EXPECT_TRUE(log_->has({"refused 'ann' (operate) at 127.0.0.1:", "has not said hello in time"}));
}

TEST_F(SecureTest, WhoSendsAByteNowAndThenIsCutOff) {
  serve_tcp();
  Raw slow(server_->port());
  const std::string hello = std::string("\x16\x03\x01\x02\x00\x01", 6) + std::string(500, '\0');
  bool closed = false;
  for (std::size_t i = 0; i < hello.size() && !closed; ++i)
    closed = slow.send(hello.substr(i, 1)) == 0 || slow.closes_within(std::chrono::milliseconds(200));
  EXPECT_TRUE(closed);
  EXPECT_TRUE(log_->has({"refused a client without a name at 127.0.0.1:", "not done in time"}));
}

/// Connections of one person, each with as many calls in progress as a client may have.
class WaitingCrowd {
 public:
  explicit WaitingCrowd(std::vector<std::unique_ptr<RobotService>> connections)
      : connections_(std::move(connections)) {
    for (const auto& connection : connections_) {
      for (std::size_t call = 0; call < detail::CallLimits::kMostOfClient; ++call) {
        calls_.push_back(std::async(std::launch::async, [this, &connection] {
          const auto events = connection->events(1000, std::chrono::hours(1));
          if (!events && events.error().code == ErrorCode::ResourceExhausted) ++refused_;
        }));
      }
    }
  }
  [[nodiscard]] RobotService& connection() const { return *connections_.front(); }
  [[nodiscard]] bool takes_all_calls() const {
    return refused_ >= calls_.size() - detail::ServerCore::kMaxCalls;
  }

 private:
  const std::vector<std::unique_ptr<RobotService>> connections_;
  std::atomic<std::size_t> refused_{0};
  std::vector<std::future<void>> calls_;  // go first
};

class CrowdedServer : public SecureTest {
 protected:
  std::vector<std::unique_ptr<RobotService>> more_connections_than_calls(const std::string& name) {
    std::vector<std::unique_ptr<RobotService>> connections;
    for (std::size_t i = 0; i <= detail::ServerCore::kMaxCalls / detail::CallLimits::kMostOfClient; ++i)
      connections.push_back(client_of(name));
    return connections;
  }
};

TEST_F(CrowdedServer, ObserversWhoWaitKeepNobodyElseFromCalling) {
  enrol({.name = "olga", .role = Role::Observe});
  enrol({.name = "olaf", .role = Role::Observe});
  serve_tcp();
  const auto ann = client_of("ann");
  const auto olaf = client_of("olaf");
  const WaitingCrowd crowd(more_connections_than_calls("olga"));
  ASSERT_TRUE(segue::testing::eventually([&] { return crowd.takes_all_calls(); }));
  EXPECT_TRUE(ann->status()) << "who operates";
  EXPECT_TRUE(olaf->status()) << "another observer";
  server_.reset();  // ends the calls
}

TEST_F(CrowdedServer, CallsThatWaitKeepNobodyFromStoppingTheRobot) {
  serve_tcp();
  const auto ann = client_of("ann");
  const WaitingCrowd crowd(more_connections_than_calls("ann"));
  ASSERT_TRUE(segue::testing::eventually([&] { return crowd.takes_all_calls(); }));
  EXPECT_EQ(ann->status().error().code, ErrorCode::ResourceExhausted);
  EXPECT_TRUE(ann->stop("ann", RealClock::instance().now() + std::chrono::minutes(1))) << "another client";
  EXPECT_TRUE(crowd.connection().stop("ann", RealClock::instance().now() + std::chrono::minutes(1)))
      << "the same client";
  server_.reset();  // ends the calls
}

TEST_F(SecureTest, WhoSaysNoHelloIsCutOff) {
  serve_tcp();
  RawTls silent(server_->port(), enrolled_, "ann");
  EXPECT_TRUE(silent.is_closed());
  EXPECT_TRUE(log_->has({"refused 'ann' (operate) at 127.0.0.1:", "has not said hello in time"}));
}

TEST_F(SecureTest, AClientThatOnlyTalksIsNotHeardForLong) {
  serve_tcp();
  const auto good = client_of("ann");
  RawTls hostile(server_->port(), enrolled_, "ann");
  const std::string flood = flood_of(400'000);
  EXPECT_LT(hostile.send(flood), flood.size());
  EXPECT_TRUE(good->status());
}

}  // namespace
}  // namespace segue::control
