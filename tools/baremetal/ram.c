/* SPDX-License-Identifier: MIT */
/* What things take in memory, as the sizes of symbols: tools/baremetal/size.sh reads them. */
#include <grobo/core/sim_static.h>
#include <grobo/core/static.h>

enum {
    JOINTS = 20,
    GOALS_FRAME_BYTES = GROBO_BOARD_HEADER_BYTES + GROBO_RS30X_OVERHEAD_BYTES + JOINTS * 5,
    READ_FRAME_BYTES = GROBO_BOARD_HEADER_BYTES + GROBO_RS30X_OVERHEAD_BYTES + 1
};

/* All that it takes to move 20 joints and to read them one by one meanwhile. */
typedef struct bus_of_20 {
    grobo_bus bus;
    grobo_txn goals, read;
    uint8_t goals_frame[GOALS_FRAME_BYTES];
    uint8_t read_frame[READ_FRAME_BYTES];
} bus_of_20;

#define RAM_OF(type) char ram_##type[sizeof(type)]

RAM_OF(grobo_posture);
RAM_OF(grobo_rs30x_parser);
RAM_OF(grobo_txn);
RAM_OF(grobo_bus);
RAM_OF(bus_of_20);
RAM_OF(grobo_sequencer);
RAM_OF(grobo_robot);
RAM_OF(grobo_sim);
