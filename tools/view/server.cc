#include "tools/view/server.h"

#include <spdlog/spdlog.h>

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "components/base/config/config.h"
#include "tools/view/frame_queue.h"
#include "tools/view/places.h"
#include "tools/view/subscriptions.h"

namespace sinew::live {

namespace internal {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = beast::error_code;
using HttpMessage = http::request<http::string_body>;

constexpr std::uint32_t kLargestHeader = 8u << 10;  // with the request line; browsers send 1 kB
constexpr std::size_t kLargestBody = 1u << 10;      // no request has one that is read
constexpr std::chrono::seconds kReplyLimit(30);     // 64 MiB at 2 MB/s
// Without a sign of life, pings included: half of it for what is on its way, a batch and the
// kernel's buffers (4 MB), at 350 kB/s.
constexpr std::chrono::seconds kIdleLimit(30);
constexpr std::size_t kMostProblems = 8;           // that one message is answered with
constexpr std::chrono::seconds kLossReports(1);    // between two to the same client
constexpr std::chrono::milliseconds kBatches(20);  // between two: the page draws every 50 ms
constexpr std::string_view kTokenQuery = "?token=";
// Nothing of the page comes from elsewhere, nothing runs in the page of another site.
constexpr const char* kContentPolicy =
    "default-src 'self'; connect-src 'self' ws:; img-src 'self' blob: data:; "
    "style-src 'self' 'unsafe-inline'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

std::string EndpointText(const Tcp::endpoint& endpoint) {
  return endpoint.address().to_string() + ":" + std::to_string(endpoint.port());
}

class Client;

// Places of one kind: with the token of the page, and without.
struct Shares {
  explicit Shares(std::size_t most) : page(most), others(most) {}
  Places page, others;
  Places* Of(bool of_page) { return of_page ? &page : &others; }
};

// Data that the connections share. The thread of the server, but for what the mutex guards.
struct Shared {
  ServerOptions options;
  std::vector<Channel> channels;
  HttpHandler handler;
  std::optional<RequestRule> rule;
  Shares connections{kMostConnections};
  Shares client_places{kMostClients};
  Places replies{kMostReplyBytes};
  mutable std::mutex mutex;
  std::set<std::shared_ptr<Client>> clients;
};

websocket::stream_base::timeout ClientTimeouts() {
  auto timeouts = websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeouts.idle_timeout = kIdleLimit;
  return timeouts;
}

// A client of the WebSocket.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(beast::tcp_stream&& stream, std::shared_ptr<Shared> shared)
      : shared_(std::move(shared)),
        socket_(std::move(stream)),
        batch_timer_(socket_.get_executor()),
        subscriptions_(shared_->channels.size()),
        queue_(shared_->options.queue_bytes) {
    Error error;
    const Tcp::endpoint remote = beast::get_lowest_layer(socket_).socket().remote_endpoint(error);
    address_ = error ? "unknown" : EndpointText(remote);
  }

  // subprotocol: one of ours. owner: of its place.
  void Start(HttpMessage request, std::string_view subprotocol, bool of_page, std::string owner) {
    place_.emplace(shared_->client_places.Of(of_page), std::move(owner), 1,
                   [this] { beast::get_lowest_layer(socket_).close(); });
    batches_ = subprotocol == kBatchSubprotocol;
    beast::get_lowest_layer(socket_).expires_never();
    socket_.set_option(ClientTimeouts());
    socket_.set_option(
        websocket::stream_base::decorator([subprotocol](websocket::response_type& reply) {
          reply.set(http::field::sec_websocket_protocol, std::string(subprotocol));
        }));
    socket_.read_message_max(kLargestClientText);
    socket_.auto_fragment(false);
    request_ = std::move(request);
    socket_.async_accept(request_, [self = shared_from_this()](Error error) {
      if (error) return;
      {
        const std::lock_guard lock(self->shared_->mutex);
        self->shared_->clients.insert(self);
      }
      spdlog::info("client {} connected", self->address_);
      const ServerOptions& options = self->shared_->options;
      self->SendText(ServerInfoText(options.name, options.session));
      self->SendText(AdvertiseText(self->shared_->channels));
      self->Read();
    });
  }

  // Any thread.
  void Offer(ChannelNumber channel, std::int64_t stamp_ns, const Payload& payload) {
    const std::lock_guard lock(mutex_);
    for (const SubscriptionNumber subscription : subscriptions_.Of(channel)) {
      queue_.Push({"", MessageDataHead(subscription, stamp_ns), payload});
      WriteSoon();
    }
  }

  ClientCounts counts() const {
    const std::lock_guard lock(mutex_);
    return {address_, subscriptions_.size(), sent_, queue_.lost(), queue_.waiting()};
  }

 private:
  void SendText(std::string text) {
    const std::lock_guard lock(mutex_);
    queue_.Push({std::move(text), {}, nullptr});
    WriteSoon();
  }

  // With the mutex. The thread of the server writes.
  void WriteSoon() {
    if (std::exchange(writing_, true)) return;
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->Write(); });
  }

  void Write() {
    ReadOn();
    {
      const std::lock_guard lock(mutex_);
      ReportLoss();
      batch_.clear();
      if (batches_) {
        for (const Frame& frame : queue_.PopData(kLargestBatch)) {
          AppendToBatch(frame.head, *frame.payload, &batch_);
          ++sent_;
        }
      }
      if (batch_.empty()) {
        std::optional<Frame> next = queue_.Pop();
        if (!next) {
          writing_ = false;
          return;
        }
        frame_ = std::move(*next);
        if (frame_.payload) ++sent_;
      }
    }
    if (!batch_.empty()) return WriteBatch();
    socket_.binary(frame_.payload != nullptr);
    const auto done = [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->End();
      self->Write();
    };
    if (frame_.payload) {
      const std::array<asio::const_buffer, 2> parts = {
          asio::buffer(frame_.head.data(), frame_.head.size()),
          asio::buffer(frame_.payload->data(), frame_.payload->size())};
      socket_.async_write(parts, done);
    } else {
      socket_.async_write(asio::buffer(frame_.text), done);
    }
  }

  void WriteBatch() {
    socket_.binary(true);
    socket_.async_write(asio::buffer(batch_),
                        [self = shared_from_this()](Error error, std::size_t) {
                          if (error) return self->End();
                          self->batch_timer_.expires_after(kBatches);
                          self->batch_timer_.async_wait([self](Error) { self->Write(); });
                        });
  }

  // With the mutex.
  void ReportLoss() {
    const auto now = std::chrono::steady_clock::now();
    if (queue_.lost() == reported_lost_ || now < next_loss_report_) return;
    if (queue_.waiting_texts() > 0) return;
    spdlog::warn("client {} reads too slowly: {} messages lost, the oldest ones", address_,
                 queue_.lost() - reported_lost_);
    reported_lost_ = queue_.lost();
    next_loss_report_ = now + kLossReports;
    queue_.Push({StatusText(StatusLevel::kWarning,
                            "this client reads too slowly: " + std::to_string(reported_lost_) +
                                " messages lost, the oldest ones",
                            "lost"),
                 {},
                 nullptr});
  }

  void Read() {
    buffer_.clear();
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->End();
      self->Take();
      self->taken_ = true;
      self->ReadOn();
    });
  }

  // A client that does not read its replies is not read.
  void ReadOn() {
    {
      const std::lock_guard lock(mutex_);
      if (queue_.waiting_texts() > 0 || !std::exchange(taken_, false)) return;
    }
    Read();
  }

  void Take() {
    if (!socket_.got_text()) {
      SendText(StatusText(StatusLevel::kError, "binary messages are not offered by this server"));
      return;
    }
    const ClientMessage message = ParseClientText(beast::buffers_to_string(buffer_.data()));
    std::vector<std::string> problems;
    {
      const std::lock_guard lock(mutex_);
      if (const auto* subscribe = std::get_if<Subscribe>(&message)) {
        problems = subscriptions_.Add(*subscribe);
      } else if (const auto* unsubscribe = std::get_if<Unsubscribe>(&message)) {
        problems = subscriptions_.Remove(*unsubscribe);
      } else {
        problems.push_back(std::get<Refused>(message).why);
      }
    }
    if (problems.size() > kMostProblems) {
      problems.resize(kMostProblems);
      problems.back() = "and more of this kind";
    }
    for (const std::string& problem : problems) {
      SendText(StatusText(StatusLevel::kError, problem));
    }
  }

  void End() {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->clients.erase(shared_from_this()) == 0) return;
    spdlog::info("client {} gone, {} messages lost", address_, counts().lost);
  }

  std::shared_ptr<Shared> shared_;
  websocket::stream<beast::tcp_stream> socket_;
  std::string address_;
  HttpMessage request_;
  beast::flat_buffer buffer_;
  bool taken_ = false;  // a message was; the next one is not read yet
  bool batches_ = false;
  asio::steady_timer batch_timer_;
  Frame frame_;                   // on its way
  std::vector<std::byte> batch_;  // likewise

  mutable std::mutex mutex_;
  Subscriptions subscriptions_;
  FrameQueue queue_;
  bool writing_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t reported_lost_ = 0;
  std::chrono::steady_clock::time_point next_loss_report_{};
  std::optional<Place> place_;
};

// A connection until it is closed or becomes a WebSocket.
class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(Tcp::socket&& socket, std::shared_ptr<Shared> shared)
      : shared_(std::move(shared)), stream_(std::move(socket)) {
    Error error;
    const Tcp::endpoint remote = stream_.socket().remote_endpoint(error);
    peer_ = error ? "unknown" : remote.address().to_string();
  }

  void Start() {
    TakePlace(false);
    Read();
  }

 private:
  // The newest of its share.
  void TakePlace(bool of_page) {
    place_.emplace(shared_->connections.Of(of_page), peer_, 1, [this] { stream_.close(); });
  }

  void Read() {
    reply_place_.reset();
    response_ = {};
    parser_.emplace();
    parser_->header_limit(kLargestHeader);
    parser_->body_limit(kLargestBody);
    stream_.expires_after(shared_->options.request_limit);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](Error error, std::size_t) {
                       if (error) return self->stream_.close();
                       self->Answer(self->parser_->release());
                     });
  }

  void Answer(HttpMessage request) {
    const RequestHead head = HeadOf(request);
    const bool of_page = shared_->rule->IsOfThePage(head);
    TakePlace(of_page);
    const std::string refusal = shared_->rule->WhyNotRead(head);
    if (!refusal.empty()) return Send(request, {403, "text/plain; charset=utf-8", refusal + "\n"});
    if (websocket::is_upgrade(request)) {
      const beast::string_view offered = request[http::field::sec_websocket_protocol];
      if (shared_->channels.empty()) {
        return Send(request, {404, "text/plain; charset=utf-8", "no live data here\n"});
      }
      const std::string_view subprotocol = ChooseSubprotocol({offered.data(), offered.size()});
      if (subprotocol.empty()) {
        return Send(request, {400, "text/plain; charset=utf-8",
                              "expected the subprotocol " + std::string(kSubprotocol) + " or " +
                                  std::string(kSdkSubprotocol) + "\n"});
      }
      place_.reset();
      std::make_shared<Client>(std::move(stream_), shared_)
          ->Start(std::move(request), subprotocol, of_page, peer_ + " " + head.origin);
      return;
    }
    HttpRequest parsed;
    parsed.method = Text(request.method_string());
    parsed.path = Text(request.target());
    if (const std::size_t mark = parsed.path.find('?'); mark != std::string::npos) {
      parsed.query = parsed.path.substr(mark + 1);
      parsed.path.resize(mark);
    }
    parsed.body = request.body();
    parsed.why_no_command = shared_->rule->WhyNotCommand(head);
    parsed.page_token = shared_->rule->TokenFor(head);
    Send(request, shared_->handler(parsed));
  }

  static std::string Text(beast::string_view view) { return {view.data(), view.size()}; }

  RequestHead HeadOf(const HttpMessage& message) {
    RequestHead head;
    head.host = Text(message[http::field::host]);
    head.origin = Text(message[http::field::origin]);
    head.token = Text(message["X-Sinew-Token"]);
    if (websocket::is_upgrade(message)) {  // to which a page can add no header
      const std::string target = Text(message.target());
      const std::size_t mark = target.find(kTokenQuery);
      if (mark != std::string::npos) head.token = target.substr(mark + kTokenQuery.size());
    }
    Error error, other;
    const Tcp::endpoint remote = stream_.socket().remote_endpoint(error);
    const Tcp::endpoint local = stream_.socket().local_endpoint(other);
    head.from_loopback =
        !error && !other && (remote.address().is_loopback() || remote.address() == local.address());
    return head;
  }

  void Send(const HttpMessage& request, HttpReply reply) {
    response_.version(request.version());
    response_.keep_alive(request.keep_alive());
    response_.result(reply.status);
    response_.set(http::field::content_type, reply.content_type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("Content-Security-Policy", kContentPolicy);
    response_.body() = std::move(reply.body);
    response_.prepare_payload();
    reply_place_.emplace(&shared_->replies, peer_, response_.body().size(),
                         [this] { stream_.close(); });
    stream_.expires_after(kReplyLimit);
    http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
      if (error || !self->response_.keep_alive()) {
        Error ignored;
        self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
        return;
      }
      self->Read();
    });
  }

  std::shared_ptr<Shared> shared_;
  std::string peer_;  // its address
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kLargestHeader + kLargestBody};
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  std::optional<Place> place_, reply_place_;
};

}  // namespace internal

using namespace internal;

int Listen(const std::string& address, unsigned short port) {
  Error error;
  const auto number = asio::ip::make_address_v4(address, error);
  if (error || number.is_unspecified()) {
    throw UsageError("address '" + address +
                     "', expected an IPv4 address of this host, such as 127.0.0.1");
  }
  asio::io_context context;
  Tcp::acceptor acceptor(context);
  const Tcp::endpoint endpoint(number, port);
  if (!error) acceptor.open(endpoint.protocol(), error);
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    throw UsageError(address + ":" + std::to_string(port) + ": " + error.message() +
                     ", expected a free port (--port)");
  }
  return acceptor.release();
}

struct Server::Impl {
  Impl(const ServerOptions& options, std::vector<Channel> channels, HttpHandler handler)
      : shared(std::make_shared<Shared>()), acceptor(context), next(context) {
    acceptor.assign(Tcp::v4(), options.listener >= 0 ? options.listener
                                                     : Listen(options.address, options.port));
    port = acceptor.local_endpoint().port();
    shared->options = options;
    shared->channels = std::move(channels);
    shared->handler = std::move(handler);
    shared->rule.emplace(options.address, port, options.token);
    Accept();
    thread = std::thread([this] { context.run(); });
  }
  ~Impl() {
    Stop();
    const std::lock_guard lock(shared->mutex);
    shared->clients.clear();
  }

  void Stop() {
    context.stop();  // the connections go with their handlers
    if (thread.joinable()) thread.join();
  }

  void Accept() {
    acceptor.async_accept(next, [this](Error error) {
      if (error == asio::error::operation_aborted) return;
      Tcp::socket socket = std::exchange(next, Tcp::socket(context));
      if (!error) {
        Error ignored;
        socket.set_option(Tcp::no_delay(true), ignored);
        std::make_shared<HttpConnection>(std::move(socket), shared)->Start();
      }
      Accept();
    });
  }

  std::shared_ptr<Shared> shared;
  asio::io_context context{1};
  Tcp::acceptor acceptor;
  Tcp::socket next;
  unsigned short port = 0;
  std::thread thread;
};

Server::Server(const ServerOptions& options, std::vector<Channel> channels, HttpHandler handler)
    : impl_(std::make_unique<Impl>(options, std::move(channels), std::move(handler))) {}

Server::~Server() = default;

unsigned short Server::port() const { return impl_->port; }

void Server::Stop() { impl_->Stop(); }

void Server::Publish(ChannelNumber channel, std::int64_t stamp_ns, std::vector<std::byte> payload) {
  const std::lock_guard lock(impl_->shared->mutex);
  if (impl_->shared->clients.empty()) return;
  const Payload shared = std::make_shared<const std::vector<std::byte>>(std::move(payload));
  for (const auto& client : impl_->shared->clients) client->Offer(channel, stamp_ns, shared);
}

std::vector<ClientCounts> Server::clients() const {
  const std::lock_guard lock(impl_->shared->mutex);
  std::vector<ClientCounts> counts;
  counts.reserve(impl_->shared->clients.size());
  for (const auto& client : impl_->shared->clients) counts.push_back(client->counts());
  return counts;
}

}  // namespace sinew::live
