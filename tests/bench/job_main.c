/* SPDX-License-Identifier: MIT */
#include "job.h"

int main(void)
{
    job_begin();
    for (;;) {
        job_read();
        job_write_one();
        job_write_many();
    }
}
