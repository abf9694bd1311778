/* SPDX-License-Identifier: MIT */
#include "src/model/joint.h"
#include "src/servo/table/items.h"

static int read_part(const grobo_driver *self, int joint, uint16_t code, grobo_exchange *exchange)
{
    const grobo_i_items *items = self->family;
    int result = items->read(self, grobo_i_joint(self->model, joint)->motor, code, exchange);
    return result < 0 ? result : 1;
}

static int check(const grobo_driver *self, void *ctx, int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_items *items = self->family;
    return part < self->model->n_joints ? read_part(self, part, items->check, exchange) : 0;
}

static int sense_more(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                      int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_items *items = self->family;
    bool of_wheel = kind == GROBO_SENSE_GOAL && grobo_i_joint_is_wheel(self->model, joint);
    const uint16_t *codes = of_wheel ? items->wheel_goal : items->senses[kind];
    uint16_t code = codes[part]; /* a part comes after the one before it */
    return code != 0 ? read_part(self, joint, code, exchange) : 0;
}

static int sense(const grobo_driver *self, void *ctx, int joint, grobo_sense_kind kind,
                 grobo_exchange *exchange)
{
    int result = sense_more(self, ctx, joint, kind, 0, exchange);
    return result < 0 ? result : GROBO_OK;
}

static int torque(const grobo_driver *self, void *ctx, grobo_joint_mask joints, grobo_torque mode,
                  int part, grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_items *items = self->family;
    int j = grobo_i_table_joint_of_part(self, joints, part);
    if (mode == GROBO_TORQUE_BRAKE || j < 0) {
        return j < 0 ? 0 : GROBO_ERR_UNSUPPORTED;
    }
    int result = items->torque(self, j, mode == GROBO_TORQUE_ON, exchange);
    return result < 0 ? result : 1;
}

static grobo_write_kind write_kind(const grobo_driver *self, const grobo_register_io *io)
{
    const grobo_i_items *items = self->family;
    const grobo_i_item *item = grobo_i_item_at(items->items, io->address, io->length);
    return item == NULL ? GROBO_WRITE_MOTOR : items->kind(item->write, io->data);
}

static int registers(const grobo_driver *self, void *ctx, const grobo_register_io *io,
                     grobo_exchange *exchange)
{
    (void)ctx;
    const grobo_i_items *items = self->family;
    const grobo_i_item *item = grobo_i_item_at(items->items, io->address, io->length);
    if (item == NULL || (io->data == NULL ? item->read : item->write) == 0) {
        return GROBO_ERR_ARG;
    }
    return io->data == NULL ? items->read(self, io->id, item->read, exchange)
                            : items->write(self, io, item->write, exchange);
}

int grobo_i_items_make(grobo_driver *made, const grobo_model *model, const grobo_protocol *protocol,
                       const grobo_i_items *items)
{
    made->check = check;
    made->torque = torque;
    made->sense = sense;
    made->sense_more = sense_more;
    made->write_kind = write_kind;
    made->registers = registers;
    return grobo_i_table_make(made, model, protocol, &items->family);
}
