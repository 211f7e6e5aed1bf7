// ALGORITHM. Rank 0 hands out piece numbers, some more than a rank has threads, fewer as the end nears; each rank's threads
// compute, and the thread that called speaks with rank 0, which stores what comes. At the end of a stage all get all
// pieces. That one thread sleeps between looks, half a millisecond, since waiting in MPI burns a core.
//
// Every rank writing a journal of its own was thought of: it would need one disk for all, or as many ranks at the next
// start, and what it saves, a piece's way to rank 0, has to be gone anyway.
#include "visibility/jobs/mpi_job_runner.h"

#define OMPI_SKIP_MPICXX  // the C++ bindings of old, which nobody links
#include <mpi.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace vismat {
namespace {

enum Tag { numbers_tag, piece_tag, error_tag, end_tag, failed_tag };

void doze() {
  std::this_thread::sleep_for(std::chrono::microseconds(500));
}

std::string what(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const std::exception& e) {
    return e.what();
  }
}

void send(int rank, Tag tag, const void* bytes, std::size_t size) {
  MPI_Send(bytes, static_cast<int>(size), MPI_BYTE, rank, tag, MPI_COMM_WORLD);
}

struct Message {
  int rank = 0, tag = 0;
  std::vector<std::byte> bytes;
};

// The next message, if one is there.
bool receive(Message& message) {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
  if (there == 0) return false;
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  message = {status.MPI_SOURCE, status.MPI_TAG, std::vector<std::byte>(static_cast<std::size_t>(size))};
  MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.rank, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return true;
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// This rank's threads: numbers go in, pieces or an error come out.
class Workers {
 public:
  using Done = std::vector<std::pair<std::uint64_t, JobRunner::Piece>>;

  Workers(unsigned threads, const std::function<JobRunner::Piece(std::uint64_t)>& piece) : piece_(piece) {
    pool_.reserve(threads);
    try {
      for (unsigned t = 0; t < threads; ++t) pool_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
      if (pool_.empty()) throw;  // otherwise those there are do the work
    }
  }
  ~Workers() {
    stop();
    pool_.clear();  // joins
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  void add(std::span<const std::uint64_t> numbers) {
    const std::lock_guard lock(mutex_);
    todo_.insert(todo_.end(), numbers.begin(), numbers.end());
    more_.notify_all();
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    more_.notify_all();
  }
  Done take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(done_, {});
  }
  std::exception_ptr error() {
    const std::lock_guard lock(mutex_);
    return error_;
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      more_.wait(lock, [&] { return stopped_ || !todo_.empty(); });
      if (stopped_) return;
      const std::uint64_t number = todo_.front();
      todo_.pop_front();
      lock.unlock();
      JobRunner::Piece piece;
      std::exception_ptr error;
      try {
        piece = piece_(number);
        if (piece.size() > INT_MAX - sizeof number) {
          throw std::runtime_error("piece " + std::to_string(number) +
                                   " has more than 2 GiB; make pieces smaller");
        }
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      if (error) {
        if (!error_) error_ = error;
        stopped_ = true;
        more_.notify_all();
        return;
      }
      done_.emplace_back(number, std::move(piece));
    }
  }

  const std::function<JobRunner::Piece(std::uint64_t)>& piece_;
  std::mutex mutex_;  // guards all below
  std::condition_variable more_;
  std::deque<std::uint64_t> todo_;
  Done done_;
  std::exception_ptr error_;
  bool stopped_ = false;
  std::vector<std::jthread> pool_;
};

class MpiJobRunner : public JobRunner {
 public:
  explicit MpiJobRunner(unsigned threads);
  ~MpiJobRunner() override;
  std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                         const std::function<Piece(std::uint64_t)>& piece, const Progress& progress) override;
  bool leads() const override { return rank_ == 0; }
  int ranks() const { return ranks_; }

 private:
  void lead(const std::string& stage, std::vector<Piece>& pieces, Workers& workers, const Progress& progress);
  void follow(Workers& workers);
  void tell_all(Tag tag, const std::string& text);

  int rank_ = 0, ranks_ = 1;
  unsigned threads_ = 1;
  std::vector<unsigned> threads_of_rank_;
  bool failed_ = false;
};

MpiJobRunner::MpiJobRunner(unsigned threads) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a rank whose mpirun was killed would wait for messages for ever
  // Ranks that read one another's memory are refused in many a container, and messages are then lost with a warning.
  ::setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 0);
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  // mpirun may have bound each rank to some cores, which is what hardware_concurrency then tells, or to none.
  MPI_Comm machine;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
  const unsigned mine = std::max(1u, std::thread::hardware_concurrency());
  const unsigned cores = static_cast<unsigned>(std::max(1l, ::sysconf(_SC_NPROCESSORS_ONLN)));
  unsigned all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED, MPI_SUM, machine);
  MPI_Comm_free(&machine);
  threads_ = threads != 0 ? threads : std::max(1u, all <= cores ? mine : mine * cores / all);
  threads_of_rank_.resize(static_cast<std::size_t>(ranks_));
  MPI_Allgather(&threads_, 1, MPI_UNSIGNED, threads_of_rank_.data(), 1, MPI_UNSIGNED, MPI_COMM_WORLD);
}

MpiJobRunner::~MpiJobRunner() {
  if (failed_ || std::uncaught_exceptions() > 0) {
    // Rank 0 goes on to tell what was wrong and to exit with 1, and mpirun then ends the others; that takes no second.
    if (rank_ != 0) std::this_thread::sleep_for(std::chrono::seconds(2));
    return;
  }
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  for (int done = 0; done == 0;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done == 0) doze();
  }
  MPI_Finalize();
}

std::vector<JobRunner::Piece> MpiJobRunner::run(const std::string& stage, std::uint64_t count,
                                                const std::function<Piece(std::uint64_t)>& piece,
                                                const Progress& progress) {
  std::vector<Piece> pieces(count);
  try {
    Workers workers(threads_, piece);
    if (rank_ == 0) {
      lead(stage, pieces, workers, progress);
    } else {
      follow(workers);
    }
  } catch (const std::exception& error) {
    failed_ = true;
    if (rank_ == 0) tell_all(failed_tag, error.what());
    throw;
  }
  if (rank_ == 0) tell_all(end_tag, {});
  for (Piece& bytes : pieces) {
    std::uint64_t size = bytes.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    bytes.resize(size);
    MPI_Bcast(bytes.data(), static_cast<int>(size), MPI_BYTE, 0, MPI_COMM_WORLD);
  }
  return pieces;
}

void MpiJobRunner::lead(const std::string& stage, std::vector<Piece>& pieces, Workers& workers,
                        const Progress& progress) {
  const std::vector<std::uint64_t> missing = missing_pieces(store_, stage, pieces);
  std::vector<std::uint64_t> given(static_cast<std::size_t>(ranks_));  // and not yet come back
  std::uint64_t next = 0, done = 0;
  bool idle = false;
  const auto take = [&](int rank, std::uint64_t number, Piece piece) {
    if (store_ != nullptr) store_->store(stage, number, piece);
    pieces[number] = std::move(piece);
    --given[static_cast<std::size_t>(rank)];
    idle = false;
    ++done;
    if (progress) progress(done, missing.size());
  };
  while (done < missing.size()) {
    idle = true;
    for (std::size_t r = 0; r < given.size() && next < missing.size(); ++r) {
      const std::uint64_t threads = threads_of_rank_[r];
      if (given[r] > threads) continue;
      const std::uint64_t share = (missing.size() - next) / (8 * given.size());
      const std::uint64_t count = std::min(std::clamp(share, threads, 64 * threads), missing.size() - next);
      const std::span numbers(missing.data() + next, count);
      if (r == 0) {
        workers.add(numbers);
      } else {
        send(static_cast<int>(r), numbers_tag, numbers.data(), numbers.size_bytes());
      }
      given[r] += count;
      next += count;
    }
    for (auto& [number, piece] : workers.take()) take(0, number, std::move(piece));
    if (const std::exception_ptr error = workers.error()) std::rethrow_exception(error);
    for (Message message; receive(message);) {
      if (message.tag == error_tag) {
        throw std::runtime_error(text_of(message.bytes) + " (rank " + std::to_string(message.rank) + ")");
      }
      std::uint64_t number = 0;
      std::memcpy(&number, message.bytes.data(), sizeof number);
      message.bytes.erase(message.bytes.begin(), message.bytes.begin() + sizeof number);
      take(message.rank, number, std::move(message.bytes));
    }
    if (idle) doze();
  }
}

void MpiJobRunner::follow(Workers& workers) {
  bool told = false;
  for (;;) {
    bool idle = true;
    for (const auto& [number, piece] : workers.take()) {
      std::vector<std::byte> bytes(sizeof number);
      std::memcpy(bytes.data(), &number, sizeof number);
      bytes.insert(bytes.end(), piece.begin(), piece.end());
      send(0, piece_tag, bytes.data(), bytes.size());
      idle = false;
    }
    if (const std::exception_ptr error = workers.error(); error && !told) {
      const std::string text = what(error);
      send(0, error_tag, text.data(), text.size());
      told = true;
    }
    Message message;
    if (receive(message)) {
      idle = false;
      if (message.tag == end_tag) return;
      if (message.tag == failed_tag) throw std::runtime_error(text_of(message.bytes));
      std::vector<std::uint64_t> numbers(message.bytes.size() / sizeof(std::uint64_t));
      std::memcpy(numbers.data(), message.bytes.data(), message.bytes.size());
      workers.add(numbers);
    }
    if (idle) doze();
  }
}

void MpiJobRunner::tell_all(Tag tag, const std::string& text) {
  for (int r = 1; r < ranks_; ++r) send(r, tag, text.data(), text.size());
}

// The ranks that mpirun says it started; 0 if it says nothing of that.
int ranks_told() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (const char* text = std::getenv(name)) return std::atoi(text);
  }
  return 0;
}

}  // namespace
}  // namespace vismat

extern "C" vismat::JobRunner* vismat_mpi_job_runner(unsigned threads) {
  auto runner = std::make_unique<vismat::MpiJobRunner>(threads);
  if (runner->ranks() < vismat::ranks_told()) {
    throw std::runtime_error(
        "the ranks do not see each other: they were not started by the mpirun of Open MPI");
  }
  return runner.release();
}
