/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of struct polyhedra (a polyhedral mesh as one rank sees it): polyhedra.c (numbering),
 * polyhedra_spread.c (the same where no rank has the whole mesh), polyhedra_cut.c (which rank has which cells),
 * polyhedra_links.c (cells and links), polyhedra_geometry.c, polyhedra_stencil.c, polyhedra_halo.c. */
#ifndef MESH_POLYHEDRA_PRIVATE_H
#define MESH_POLYHEDRA_PRIVATE_H

#include "mesh/polyhedral/polyhedra.h"
#include "mesh/spread/spread.h"

enum {
    MOST_RINGS = 6,    /* a stencil that is still too small then grows no further */
    MOST_IMAGES = 8192 /* images of a periodic domain that MOST_RINGS crossings of cyclic patches can reach */
};

/* The mesh, or the part of it that a rank has, as cells and links. A link is a solved face (not a face of an empty
 * patch); the two faces of a cyclic pair are one link. Vectors are in computational axes but for face_centre and
 * face_area. */
struct links {
    struct pool *pool;
    const struct polymesh *all;   /* the whole mesh: its counts and patches */
    const struct polymesh *mesh;  /* the arrays: of all, or of the part */
    const struct mesh_part *part; /* NULL: this rank has the whole mesh */
    int dim, axis[3];
    bool gone[3];                    /* is the physical axis empty? */
    double middle[3], extent;        /* centre of the mesh's box along x y z, its longest side, m */
    double thickness;                /* m^(3-dim) */
    double *face_centre, *face_area; /* [nfaces][3] */
    int n;                           /* number of links, in the order of `face` */
    int *face, *twin;                /* [n] face of the left cell; face of the right cell of a cyclic pair, else -1 */
    int *left, *right;               /* [n] cells; right is -1 at the boundary */
    int *patch;                      /* [n] patch, -1 inside */
    /* [n] step in `next` that a crossing from left to right takes; -1: it stays in the same image */
    int *step;
    /* [ncells + 1]; links of a cell, ascending, ~link where the cell is on the right */
    int *cell_start, *cell_link;
    int ntranslations, nimages;
    double (*translation)[3]; /* [ntranslations] step 2 i adds number i, step 2 i + 1 takes it off */
    double (*image)[3];       /* [nimages] shift; image 0 is none */
    int *next;                /* [nimages][2 ntranslations] image after a step, -1: too far */
};
status links_make(struct pool *pool, const struct polymesh *all, const struct mesh_part *part, struct links *l);
/* Numbers in the whole mesh. */
int links_cell_name(const struct links *l, int cell);
int links_face_name(const struct links *l, int face);

/* Crosses link `code` (of cell_link) out of its cell in image `image`: returns the cell beyond (-1: none), *to_image is
 * that cell's image. */
int links_cross(const struct links *l, int code, int image, int *to_image);

/* Returns the polyMesh face of a link code on the side of the code's own cell; *outward: is the face's normal outward
 * of that cell? */
int links_face(const struct links *l, int code, bool *outward);

/* Finds the ends of a solved face of a 2D mesh, points p and q; its area vector is (y_q - y_p, x_p - x_q). Returns
 * false if the face is no extruded edge. */
bool links_edge(const struct links *l, int face, int *p, int *q);

struct cut_mesh { /* what is cut: of a mesh that is spread, the part that a rank has read; else the mesh */
    const struct polymesh *mesh;
    const bool *whole; /* the cells of the slice, and numbers of all in the whole mesh; NULL where this is that */
    const int *cell;
    struct share cells;   /* the ranks that cut it, each a slice: all, or this one alone */
    const double *centre; /* [cells of the slice][3] m */
    int dim, axis[3];
    double low[3], high[3]; /* m */
    int nblocks;            /* cut_cells sets it */
};
struct cut {      /* the mesh in blocks, the blocks on ranks */
    int nblocks;  /* number of blocks of all ranks */
    int *rank_of; /* [nblocks] */
    struct share cells;
    int *block; /* [cells of the slice] */
};
/* Collective over the ranks c, which the mesh is dealt to. */
status cut_cells(struct cut_mesh *m, const struct comm *c, struct cut *cut);
void cut_cells_free(struct cut *cut);

struct polyhedra_private {
    int nlinks;
    struct comm_link *link;       /* [nlinks] messages; n is the longer of what leaves and what arrives */
    int *send_start, *send;       /* [nlinks + 1]; my cells that leave */
    int *receive_start, *receive; /* [nlinks + 1]; ghosts that arrive */
    struct comm_exchange *exchange;
    int nvar; /* variables of the fill under way */
    double *const *data;
};
/* Plans the ghost exchange: rank[ncells - nown] says which rank has a ghost. Collective. */
status halo_make(struct polyhedra *m, const int *rank);

struct member { /* a member of a stencil */
    int cell;   /* of the links, or ~link for the mirror there */
    int image, ring;
};
/* A stencil that grows ring by ring. */
struct grower {
    struct pool *pool;
    const struct links *l;
    int rings, wanted;
    int *seen; /* [ncells] stamp of the last stencil that had the cell as a member */
    int stamp;
    int n, room; /* member[0] is the cell itself */
    struct member *member;
};
status grower_make(struct pool *pool, const struct links *l, int rings, struct grower *g);
status grower_run(struct grower *g, int cell);

/* Fills stencils and corners. mirror_of[links] is the mirror at a link, or -1. */
status stencil_make(struct polyhedra *m, struct grower *g, const int *local, const int *mirror_of);

/* Fills all geometry; link_of[faces] and mirror_link[mirrors] are the links of faces and mirrors. */
/* local: [cells of the links] number on this rank, or below 0. */
status geometry_make(struct polyhedra *m, const struct links *l, const int *local, const int *link_of,
                     const int *mirror_link, int order);

/* Takes `count` lines[n] of m's pool. */
status lines_make(struct polyhedra *m, double **line, int count, long n, const char *what);

#endif
