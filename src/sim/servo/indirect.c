/* SPDX-License-Identifier: MIT */
/* Indirect addresses of simulated DYNAMIXEL: each lends its register to another address. */
#include <string.h>

#include "src/base/bytes.h"
#include "src/sim/servo/indirect.h"
#include "src/sim/servo/registers.h"

/* Registers in RAM begin with the switch of the torque, and an indirect address is one of them
 * (emanual, XL430-W250 and PH54-200-S500-R). */
static int ram_of(const grobo_sim_servo *servo)
{
    return grobo_servo_register_of(servo->model, GROBO_ROLE_TORQUE)->address;
}

/* Where a byte of a run is: its index among all of the model, -1: in none. */
static int index_of(const grobo_sim_servo *servo, int address, bool data)
{
    int before = 0;
    for (int i = 0; i < servo->model->indirect_count; i++) {
        const grobo_servo_indirect *run = &servo->model->indirect[i];
        int begin = data ? run->data : run->address;
        int bytes = data ? run->count : 2 * run->count;
        if (address >= begin && address < begin + bytes && before < GROBO_SIM_INDIRECTS) {
            return (data ? before : 2 * before) + address - begin;
        }
        before += run->count;
    }
    return -1;
}

static int most_of(const grobo_sim_servo *servo)
{
    int most = grobo_i_dxl_end(servo) - 1;
    for (int i = 0; i < servo->model->indirect_count; i++) {
        const grobo_servo_indirect *run = &servo->model->indirect[i];
        int end = run->data + run->count - 1;
        most = end > most ? end : most;
    }
    return most;
}

/* Of P and PRO they are in the EEPROM (emanual, PH54-200-S500-R), of all others in RAM. */
bool grobo_i_indirect_kept(const grobo_sim_servo *servo)
{
    return servo->model->indirect_count > 0 && servo->model->indirect[0].address < ram_of(servo);
}

/* Each address is that of its own data. */
static void own_addresses(grobo_sim_servo *servo)
{
    int k = 0;
    for (int i = 0; i < servo->model->indirect_count; i++) {
        const grobo_servo_indirect *run = &servo->model->indirect[i];
        for (int j = 0; j < run->count && k < GROBO_SIM_INDIRECTS; j++, k++) {
            servo->indirect[k] = (uint16_t)(run->data + j);
        }
    }
}

void grobo_i_indirect_factory(grobo_sim_servo *servo)
{
    own_addresses(servo);
}

void grobo_i_indirect_restart(grobo_sim_servo *servo)
{
    if (!grobo_i_indirect_kept(servo)) {
        own_addresses(servo);
    }
    memset(servo->indirect_data, 0, sizeof servo->indirect_data);
}

/* Where a byte of the block really is: an address of the table, or of indirect data for STORE. */
static grobo_i_indirect_kind target_of(const grobo_sim_servo *servo, int address, int *target)
{
    int k = index_of(servo, address, true);
    *target = address;
    if (k >= 0) {
        *target = servo->indirect[k];
        return index_of(servo, *target, true) >= 0 ? GROBO_I_INDIRECT_STORE
                                                   : GROBO_I_INDIRECT_REGISTERS;
    }
    return index_of(servo, address, false) >= 0 ? GROBO_I_INDIRECT_ADDRESS
                                                : GROBO_I_INDIRECT_REGISTERS;
}

grobo_i_indirect_piece grobo_i_indirect_piece_at(const grobo_sim_servo *servo, int address,
                                                 size_t n)
{
    int target, next;
    grobo_i_indirect_piece piece = {.kind = target_of(servo, address, &target), .n = 1};
    piece.address = piece.kind == GROBO_I_INDIRECT_REGISTERS ? target : address;
    while (piece.n < n && target_of(servo, address + (int)piece.n, &next) == piece.kind &&
           (piece.kind != GROBO_I_INDIRECT_REGISTERS || next == target + (int)piece.n)) {
        piece.n++;
    }
    return piece;
}

bool grobo_i_indirect_fits(const grobo_sim_servo *servo, const grobo_i_indirect_piece *piece,
                           const uint8_t *bytes)
{
    bool whole = index_of(servo, piece->address, false) % 2 == 0 && piece->n % 2 == 0;
    for (size_t i = 0; whole && i < piece->n; i += 2) {
        int target = grobo_i_get_u16(bytes + i);
        whole = target >= ram_of(servo) && target <= most_of(servo);
    }
    return whole;
}

void grobo_i_indirect_write(grobo_sim_servo *servo, const grobo_i_indirect_piece *piece,
                            const uint8_t *bytes)
{
    for (size_t i = 0; i < piece->n; i++) {
        int address = piece->address + (int)i, target;
        if (piece->kind == GROBO_I_INDIRECT_STORE) {
            (void)target_of(servo, address, &target);
            servo->indirect_data[index_of(servo, target, true)] = bytes[i];
        } else if (i % 2 == 0) {
            servo->indirect[index_of(servo, address, false) / 2] = grobo_i_get_u16(bytes + i);
        }
    }
}

bool grobo_i_indirect_readable(const grobo_sim_servo *servo, int address, int length)
{
    int end = grobo_i_dxl_end(servo);
    bool there = true;
    for (int i = 0; i < length && there; i++) {
        there = address + i < end || index_of(servo, address + i, true) >= 0 ||
                index_of(servo, address + i, false) >= 0;
    }
    return there;
}

void grobo_i_indirect_read(const grobo_sim_servo *servo, int address, int length, uint8_t *to)
{
    int end = grobo_i_dxl_end(servo);
    for (int i = 0; i < length; i++) {
        int target;
        grobo_i_indirect_kind kind = target_of(servo, address + i, &target);
        if (kind == GROBO_I_INDIRECT_STORE) {
            to[i] = servo->indirect_data[index_of(servo, target, true)];
        } else if (kind == GROBO_I_INDIRECT_ADDRESS) {
            int byte = index_of(servo, address + i, false);
            to[i] = (uint8_t)(servo->indirect[byte / 2] >> 8 * (byte % 2));
        } else {
            to[i] = target < end ? servo->reg[target] : 0;
        }
    }
}
