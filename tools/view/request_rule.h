// Rights to have the page, and to command through it. Pure: any thread.
//
// A browser shows many sites at once, and each of them can send requests to this host. Hence:
//   - the Host header must be an address of this server, so that a foreign name that resolves to it
//     (DNS rebinding) gets nothing;
//   - a command needs the token, which only the page itself is given, and only on loopback, and the
//     Origin of the page;
//   - places are kept for what has the token (server.h), whatever others open.
// The WebSocket sends data and takes no commands: viewers of other origins may read it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sinew::live {

struct RequestHead {
  std::string host;    // header Host: "127.0.0.1:8765"
  std::string origin;  // header Origin; empty: none
  std::string token;   // header X-Sinew-Token, of a WebSocket ?token=; empty: none
  bool from_loopback = false;
};

class RequestRule {
 public:
  // address: the one listened on. token: at least 16 characters, else std::invalid_argument.
  RequestRule(const std::string& address, unsigned port, std::string token);

  // Empty: yes. Else why not.
  std::string WhyNotRead(const RequestHead& request) const;
  std::string WhyNotCommand(const RequestHead& request) const;
  // With the page's token, and not from another page. Browsers send no Origin with a GET.
  bool IsOfThePage(const RequestHead& request) const;
  // The page's token; empty for a page that is not asked for from loopback.
  std::string TokenFor(const RequestHead& request) const;

 private:
  std::vector<std::string> hosts_;
  std::string token_;
};

// Equal, in a time that does not depend on where the texts differ.
bool EqualInConstantTime(std::string_view a, std::string_view b);

}  // namespace sinew::live
