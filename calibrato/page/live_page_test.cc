#include "calibrato/page/live_page.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

// All that comes back before the server hangs up.
std::string Ask(int port, const std::string& request) {
  const int connection = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  std::string answer;
  if (connect(connection, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
      send(connection, request.data(), request.size(), MSG_NOSIGNAL) > 0) {
    char buffer[4096];
    for (ssize_t size = 0; (size = recv(connection, buffer, sizeof buffer, 0)) > 0;) {
      answer.append(buffer, static_cast<size_t>(size));
    }
  }
  close(connection);
  return answer;
}

bool Has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(LivePage, AnswersWithWhatThereIsNow) {
  std::string content = "first";
  LivePage page(0, "--live",
                {[&] { return "<p>" + content + "</p>"; }, [] { return std::string("{}\n"); }});
  EXPECT_GT(page.port(), 0);
  EXPECT_EQ(page.address(), "http://127.0.0.1:" + std::to_string(page.port()) + "/");
  const std::string first = Ask(page.port(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(Has(first, "HTTP/1.1 200 OK\r\n"));
  EXPECT_TRUE(Has(first, "Content-Length: 12\r\n"));
  EXPECT_TRUE(Has(first, "Refresh: 5\r\n"));
  EXPECT_TRUE(first.ends_with("\r\n\r\n<p>first</p>"));
  content = std::string(3'000'000, 'x');  // More than a socket takes at once.
  EXPECT_GT(Ask(page.port(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n").size(), content.size());
  EXPECT_TRUE(
      Ask(page.port(), "GET /data HTTP/1.1\r\nHost: localhost\r\n\r\n").ends_with("\r\n\r\n{}\n"));
}

TEST(LivePage, SurvivesWhatItDoesNotUnderstand) {
  LivePage page(0, "--live",
                {[]() -> std::string { throw std::runtime_error("not yet"); },
                 [] { return std::string("[]"); }});
  EXPECT_TRUE(Has(Ask(page.port(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"), "500 Internal"));
  EXPECT_TRUE(
      Has(Ask(page.port(), "GET /../secret HTTP/1.1\r\nHost: localhost\r\n\r\n"), "404 Not Found"));
  EXPECT_TRUE(Has(Ask(page.port(), "DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n"), "405 Method"));
  EXPECT_TRUE(Has(Ask(page.port(), std::string(20000, 'a')), "400 Bad Request"));
  EXPECT_TRUE(Has(Ask(page.port(), "GET /data HTTP/1.1\r\n\r\n"), "403 Forbidden"));
  EXPECT_TRUE(
      Has(Ask(page.port(), "GET /data HTTP/1.1\r\nHost: evil.example\r\n\r\n"), "403 Forbidden"));
  EXPECT_TRUE(Ask(page.port(), "GET /data HTTP/1.1\r\nHost: localhost\r\n\r\n").ends_with("[]"));
}

TEST(LivePage, ListensOnTheLoopbackInterfaceAlone) {
  const LivePage page(0, "--live", {[] { return std::string(); }, [] { return std::string(); }});
  char port[8];
  std::snprintf(port, sizeof port, ":%04X", static_cast<unsigned>(page.port()));
  std::ifstream sockets("/proc/net/tcp");
  int num_listening = 0;
  for (std::string line; std::getline(sockets, line);) {
    const size_t place = line.find(port);
    const bool is_local = place != std::string::npos && place < 20;
    if (!is_local || !Has(line, "00000000:0000 0A")) continue;  // 0A: listening.
    ++num_listening;
    EXPECT_TRUE(Has(line, "0100007F" + std::string(port))) << line;
  }
  EXPECT_EQ(num_listening, 1);
}

TEST(LivePage, NamesAPortThatIsTaken) {
  const LivePage::Content content{[] { return std::string(); }, [] { return std::string(); }};
  const LivePage page(0, "--live", content);
  try {
    const LivePage second(page.port(), "--live", content);
    ADD_FAILURE() << "two pages on one port";
  } catch (const InputError& error) {
    EXPECT_TRUE(Has(error.what(), "port " + std::to_string(page.port())));
    EXPECT_TRUE(Has(error.what(), "--live"));
  }
}

}  // namespace
}  // namespace calibrato
