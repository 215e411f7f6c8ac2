// Runs work that waits for a disk outside the network thread. One of the files that use Asio's
// coroutines.
#pragma once

#include <utility>  // Boost 1.74's awaitable.hpp needs it and does not include it

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <memory>

namespace hermite::server {

// Runs `work` on a thread of `pool`, and resumes on the calling thread. `work` is a named variable,
// since it has to outlive the wait.
template <class Work>
boost::asio::awaitable<void> run_on(boost::asio::thread_pool& pool, Work& work) {
  namespace asio = boost::asio;
  auto initiate = [&pool, &work](auto handler) {
    auto shared = std::make_shared<decltype(handler)>(std::move(handler));
    asio::post(pool, [shared = std::move(shared), &work]() mutable {
      work();
      const auto executor = asio::get_associated_executor(*shared);
      asio::post(executor, [shared = std::move(shared)] { (*shared)(); });
    });
  };
  co_await asio::async_initiate<const asio::use_awaitable_t<>, void()>(initiate,
                                                                       asio::use_awaitable);
}

}  // namespace hermite::server
