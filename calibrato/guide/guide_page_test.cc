#include "calibrato/guide/guide_page.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "calibrato/base/input_error_testing.h"
#include "calibrato/base/rng.h"

namespace calibrato {
namespace {

constexpr const char* kHost = "Host: 127.0.0.1\r\n";

int Connect(int port) {
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    close(connection);
    return -1;
  }
  return connection;
}

bool Send(int connection, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t size = send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (size <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(size));
  }
  return true;
}

std::string ReadAll(int connection, int patience_ms = 8000) {
  std::string answer;
  char buffer[4096];
  pollfd waiting{connection, POLLIN, 0};
  while (poll(&waiting, 1, patience_ms) > 0) {
    const ssize_t size = recv(connection, buffer, sizeof buffer, 0);
    if (size <= 0) break;
    answer.append(buffer, static_cast<size_t>(size));
  }
  return answer;
}

std::string Ask(int port, const std::string& request) {
  const int connection = Connect(port);
  if (connection < 0) return "";
  Send(connection, request);
  std::string answer = ReadAll(connection);
  close(connection);
  return answer;
}

std::string Get(int port, const std::string& target, const std::string& headers = kHost) {
  return Ask(port, "GET " + target + " HTTP/1.1\r\n" + headers + "\r\n");
}

int StatusOf(const std::string& answer) {
  return answer.rfind("HTTP/1.1 ", 0) == 0 ? std::atoi(answer.c_str() + 9) : 0;
}

std::string BodyOf(const std::string& answer) {
  const size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

class ServedPage : public testing::Test {
 protected:
  void Open(const std::string& host) {
    page_.emplace(
        host, 0,
        GuidePage::Content{[] { return std::string("{\"kind\": \"guide\"}"); },
                           [this] { return has_image_ ? std::string("\xff\xd8 jpeg") : ""; },
                           [this] { return has_report_ ? std::string("<p>") : ""; },
                           [this] { ++num_ends_; }},
        [this](const std::string& address) { addresses_.push_back(address); });
  }
  int port() const { return page_->port(); }
  void ExpectAlive() const { EXPECT_EQ(StatusOf(Get(port(), "/state")), 200); }

  std::atomic<bool> has_image_ = true;
  std::atomic<bool> has_report_ = false;
  std::atomic<int> num_ends_ = 0;
  std::vector<std::string> addresses_;
  std::optional<GuidePage> page_;
};

TEST_F(ServedPage, AnswersItsFewAddressesAndNoOther) {
  Open("127.0.0.1");
  ASSERT_EQ(addresses_.size(), 1U);
  EXPECT_EQ(addresses_[0], "http://127.0.0.1:" + std::to_string(port()) + "/");
  EXPECT_NE(BodyOf(Get(port(), "/")).find("<title>calibrato guide</title>"), std::string::npos);
  EXPECT_EQ(BodyOf(Get(port(), "/state")), "{\"kind\": \"guide\"}");
  EXPECT_EQ(BodyOf(Get(port(), "/frame")), "\xff\xd8 jpeg");
  EXPECT_EQ(StatusOf(Get(port(), "/report")), 404);
  has_report_ = true;
  EXPECT_EQ(BodyOf(Get(port(), "/report")), "<p>");
  for (const char* target :
       {"/../../../../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
        "/report/../../etc/passwd", "//etc/passwd", "/etc/passwd", "/state/", "/frame.jpg",
        "/./state", "/sensor.yaml", "/cam0/1.png", "/report%00.html"}) {
    const std::string answer = Get(port(), target);
    EXPECT_EQ(StatusOf(answer), 404) << target;
    EXPECT_EQ(answer.find("root:"), std::string::npos) << target;
  }
}

// Asked ten times a second of a recording without images: nothing, and no fault.
TEST_F(ServedPage, HasNoContentWhereThereIsNoImage) {
  Open("127.0.0.1");
  has_image_ = false;
  const std::string answer = Get(port(), "/frame");
  EXPECT_EQ(StatusOf(answer), 204);
  EXPECT_EQ(BodyOf(answer), "");
  has_image_ = true;
  EXPECT_EQ(StatusOf(Get(port(), "/frame")), 200);
}

TEST_F(ServedPage, EndsOnlyByItsOwnButton) {
  Open("127.0.0.1");
  EXPECT_EQ(StatusOf(Get(port(), "/end")), 405);
  const std::string post = "POST /end HTTP/1.1\r\nHost: localhost\r\n";
  EXPECT_EQ(StatusOf(Ask(port(), post + "\r\n")), 405);
  EXPECT_EQ(num_ends_, 0);
  EXPECT_EQ(StatusOf(Ask(port(), post + "X-Calibrato: end\r\nContent-Length: 0\r\n\r\n")), 200);
  EXPECT_EQ(num_ends_, 1);
}

// A name from elsewhere that was made to point here.
TEST_F(ServedPage, OnLoopbackAnswersToItsOwnNamesOnly) {
  Open("127.0.0.1");
  EXPECT_EQ(StatusOf(Get(port(), "/state", "Host: localhost:" + std::to_string(port()) + "\r\n")),
            200);
  EXPECT_EQ(StatusOf(Get(port(), "/state", "Host: evil.example\r\n")), 403);
  EXPECT_EQ(StatusOf(Get(port(), "/state", "Host: 127.0.0.1.evil.example\r\n")), 403);
  EXPECT_EQ(StatusOf(Get(port(), "/state", "")), 403);
}

TEST_F(ServedPage, OnTheNetworkTakesATokenThatIsGoodForOneBrowser) {
  Open("0.0.0.0");
  ASSERT_EQ(addresses_.size(), 1U);
  const auto token_of = [](const std::string& address) {
    return address.substr(address.find("?token=") + 7);
  };
  const std::string token = token_of(addresses_[0]);
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(StatusOf(Get(port(), "/")), 403);
  EXPECT_EQ(StatusOf(Get(port(), "/?token=")), 403);
  EXPECT_EQ(StatusOf(Get(port(), "/?token=" + std::string(32, '0'))), 403);
  EXPECT_EQ(StatusOf(Get(port(), "/state", "Cookie: calibrato_guide=\r\n")), 403);
  const std::string welcome = Get(port(), "/?token=" + token);
  ASSERT_EQ(StatusOf(welcome), 303);
  EXPECT_NE(welcome.find("; HttpOnly; SameSite=Lax;"), std::string::npos);
  const size_t at = welcome.find("calibrato_guide=");
  const std::string cookie = "Cookie: " + welcome.substr(at, welcome.find(';', at) - at) + "\r\n";
  EXPECT_EQ(StatusOf(Get(port(), "/state", cookie)), 200);
  // The second browser needs the second token, and takes nothing from the first.
  EXPECT_EQ(StatusOf(Get(port(), "/?token=" + token)), 403);
  ASSERT_EQ(addresses_.size(), 2U);
  EXPECT_EQ(StatusOf(Get(port(), "/?token=" + token_of(addresses_[1]))), 303);
  EXPECT_EQ(StatusOf(Get(port(), "/state", cookie)), 200);
  EXPECT_EQ(StatusOf(Get(port(), "/state")), 403);
}

TEST_F(ServedPage, ServesTwoBrowsersAtATime) {
  Open("127.0.0.1");
  std::atomic<int> num_good = 0;
  std::vector<std::thread> browsers;
  for (int k = 0; k < 2; ++k) {
    browsers.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        if (StatusOf(Get(port(), i % 2 == 0 ? "/state" : "/frame")) == 200) ++num_good;
      }
    });
  }
  for (std::thread& browser : browsers) browser.join();
  EXPECT_EQ(num_good, 100);
}

TEST_F(ServedPage, RefusesAGigabyteUnread) {
  Open("127.0.0.1");
  const auto peak_kb = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const auto before_kb = peak_kb();
  for (const char* kind : {"Content-Length: 1000000000", "Transfer-Encoding: chunked"}) {
    const int connection = Connect(port());
    ASSERT_GE(connection, 0);
    EXPECT_TRUE(
        Send(connection, std::string("POST /end HTTP/1.1\r\n") + kHost + kind + "\r\n\r\n"));
    EXPECT_EQ(StatusOf(ReadAll(connection)), 413) << kind;
    // It would go on for a thousand of these.
    const std::string megabyte(1 << 20, 'x');
    int sent = 0;
    while (sent < 1000 && Send(connection, megabyte)) ++sent;
    EXPECT_LT(sent, 100) << kind;
    close(connection);
  }
  // So does a head without an end.
  const int connection = Connect(port());
  std::string endless = "GET / HTTP/1.1\r\n";
  int sent = 0;
  while (sent < 100'000 && Send(connection, endless)) {
    endless = "X-More: " + std::string(1000, 'a') + "\r\n";
    ++sent;
  }
  EXPECT_LT(sent, 100'000);
  close(connection);
  EXPECT_LT(peak_kb() - before_kb, 50'000);
  ExpectAlive();
}

// Connections that say nothing, or a byte at a time, are cut off; others are served meanwhile.
TEST_F(ServedPage, IsNotHeldUpByTheSlow) {
  Open("127.0.0.1");
  std::vector<int> silent;
  for (int k = 0; k < 14; ++k) silent.push_back(Connect(port()));
  ExpectAlive();
  const int slow = Connect(port());
  const auto begin = std::chrono::steady_clock::now();
  while (Send(slow, "G") && std::chrono::steady_clock::now() - begin < std::chrono::seconds(10)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(8));
  close(slow);
  for (const int connection : silent) close(connection);
  ExpectAlive();
}

// A hostile client: pieces of requests, changed at random, cut off anywhere. For ten minutes with
// CALIBRATO_FUZZ_SECONDS=600; a second by default.
TEST_F(ServedPage, OutlivesAHostileClient) {
  Open("127.0.0.1");
  const char* const asked = std::getenv("CALIBRATO_FUZZ_SECONDS");
  const double seconds = asked != nullptr ? std::atof(asked) : 1.0;
  const std::vector<std::string> pieces = {"GET ",
                                           "POST ",
                                           "/state",
                                           "/end",
                                           "/../..",
                                           " HTTP/1.1\r\n",
                                           "Host: ",
                                           "127.0.0.1",
                                           "\r\n",
                                           "\r\n\r\n",
                                           "Content-Length: ",
                                           "99999999999999999999",
                                           "Cookie: calibrato_guide=",
                                           "X-Calibrato: end\r\n",
                                           "Transfer-Encoding: chunked\r\n",
                                           "%00",
                                           "\xff\xfe",
                                           ":",
                                           "?token=",
                                           "&&==",
                                           "Expect: 100-continue\r\n"};
  Rng rng(9);
  int num_asked = 0;
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() <
         seconds) {
    std::string request;
    const auto num_pieces = 1 + rng.UniformIndex(12);
    for (uint64_t k = 0; k < num_pieces; ++k) request += pieces[rng.UniformIndex(pieces.size())];
    for (uint64_t k = rng.UniformIndex(4); k > 0 && !request.empty(); --k) {
      request[rng.UniformIndex(request.size())] = static_cast<char>(rng.NextBits());
    }
    if (rng.UniformIndex(20) == 0) request += std::string(rng.UniformIndex(40'000), 'z');
    const int connection = Connect(port());
    ASSERT_GE(connection, 0) << "after " << num_asked;
    Send(connection, request);
    // Half of them hang up at once, the others after an answer or a moment.
    if (rng.UniformIndex(2) == 0) {
      shutdown(connection, SHUT_WR);
      const std::string answer = ReadAll(connection, 3000);
      EXPECT_EQ(answer.find("root:"), std::string::npos);
    }
    close(connection);
    ++num_asked;
    if (num_asked % 500 == 0) ExpectAlive();
  }
  std::printf("%d hostile requests\n", num_asked);
  ExpectAlive();
}

TEST(GuidePage, RefusesAHostThatIsNoneOfThisMachine) {
  EXPECT_THROW(HttpServer("192.0.2.1", 0, {}, "another"), InputError);
  EXPECT_THROW(HttpServer("not-an-address", 0, {}, "another"), InputError);
}

}  // namespace
}  // namespace calibrato
