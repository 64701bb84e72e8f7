#include "process.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static int read_whole(int from, char* out, size_t size)
{
  size_t done = 0;
  while (done < size)
  {
    const ssize_t got = read(from, out + done, size - done);
    if (got <= 0)
    {
      return 1;
    }
    done += (size_t)got;
  }
  return 0;
}

static int write_whole(int to, const char* from, size_t size)
{
  size_t done = 0;
  while (done < size)
  {
    const ssize_t put = write(to, from + done, size - done);
    if (put <= 0)
    {
      return 1;
    }
    done += (size_t)put;
  }
  return 0;
}

static void explain(int state, unsigned seconds, char message[BENCH_MESSAGE_SIZE])
{
  if (WIFSIGNALED(state) && WTERMSIG(state) == SIGALRM)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "It did not end in %u s.", seconds);
  }
  else
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "%s",
      WIFSIGNALED(state) ? strsignal(WTERMSIG(state)) : "The run's process was lost.");
  }
}

int bench_process_run(bench_work work, const void* job, unsigned seconds, size_t size, void* out,
  char message[BENCH_MESSAGE_SIZE])
{
  int ends[2];
  fflush(NULL);
  if (pipe(ends) != 0)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "There is no pipe for the run's process.");
    return 1;
  }
  const pid_t child = fork();
  if (child == 0)
  {
    close(ends[0]);
    alarm(seconds);
    work(job, out);
    _exit(write_whole(ends[1], out, size));
  }
  close(ends[1]);
  int is_lost = 1;
  if (child < 0)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "The run's process cannot be started.");
  }
  else
  {
    int state = 0;
    is_lost = read_whole(ends[0], out, size);
    waitpid(child, &state, 0);
    if (is_lost)
    {
      explain(state, seconds, message);
    }
  }
  close(ends[0]);
  return is_lost;
}
