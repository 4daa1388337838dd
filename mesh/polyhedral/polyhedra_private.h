/* Shared by polyhedra.c (numbering), polyhedra_links.c (the whole mesh), polyhedra_geometry.c, polyhedra_stencil.c,
 * polyhedra_halo.c.
 */
#ifndef MESH_POLYHEDRA_PRIVATE_H
#define MESH_POLYHEDRA_PRIVATE_H

#include "mesh/polyhedral/polyhedra.h"

enum {
    MOST_RINGS = 6,    /* a stencil that is still too small then stays so */
    MOST_IMAGES = 8192 /* of the domain, MOST_RINGS crossings of cyclic patches away */
};

/* The whole mesh as cells and links, the same on every rank. A link is a solved face (not one of an empty patch); the
 * two faces of a cyclic pair are one link. Vectors are in computational axes but for face_centre and face_area. */
struct links {
    const struct polymesh *mesh;
    int dim, axis[3];
    bool gone[3];                    /* physical axis is empty */
    double middle[3], extent;        /* of the mesh, along x y z and the longest, m */
    double thickness;                /* m^(3-dim) */
    double *face_centre, *face_area; /* [nfaces][3] */
    int n;                           /* links, in the order of `face` */
    int *face, *twin;                /* [n] face of the left cell; of a cyclic pair that of the right cell, else -1 */
    int *left, *right;               /* [n] polyMesh cells; right is -1 at the boundary */
    int *patch;                      /* [n] -1 inside */
    int *step;                       /* [n] on crossing from left to right, which of the `next` images; -1: the same */
    int *cell_start, *cell_link;     /* [ncells + 1]; ~link where the cell is on the right; ascending links */
    int ntranslations, nimages;
    double (*translation)[3]; /* [ntranslations] step 2 i adds number i, step 2 i + 1 takes it off */
    double (*image)[3];       /* [nimages] shift; image 0 is none */
    int *next;                /* [nimages][2 ntranslations] image after a step, -1: too far */
};
status links_make(const struct polymesh *m, struct links *l);
void links_free(struct links *l);

/* Over link `code` of cell_link: the cell beyond (-1: none) and its image, from image `image` of this one. */
int links_cross(const struct links *l, int code, int image, int *to_image);

/* The polyMesh face of a link code as its own cell has it, and whether its points and area are outward there. */
int links_face(const struct links *l, int code, bool *outward);

/* Ends of a solved face of a 2D mesh: points p, q; its area vector is (y_q - y_p, x_p - x_q). False: none can be told.
 */
bool links_edge(const struct links *l, int face, int *p, int *q);

struct cut {       /* the mesh in blocks, the blocks on ranks */
    int nblocks;   /* of all ranks */
    int *block_of; /* [ncells] */
    int *rank_of;  /* [nblocks] */
    int *start;    /* [nblocks + 1] into order */
    int *order;    /* [ncells] polyMesh cells, block by block, neighbours near each other */
};
status cut_cells(const struct links *l, const struct comm *c, struct cut *cut);
void cut_cells_free(struct cut *cut);

struct polyhedra_private {
    int nlinks;
    struct comm_link *link;       /* [nlinks] ranks; n is the longer of what leaves and what arrives */
    int *send_start, *send;       /* [nlinks + 1] my cells */
    int *receive_start, *receive; /* [nlinks + 1] ghosts */
    struct comm_exchange *exchange;
    int nvar; /* of the fill under way */
    double *const *data;
};
/* rank: [ncells - nown] of the ghosts. local: [ncells_all] number of my cells. Collective. */
status halo_make(struct polyhedra *m, const int *rank, const int *local);
void halo_free(struct polyhedra_private *h);

struct member { /* of a stencil */
    int cell;   /* polyMesh cell, or ~link: the mirror there */
    int image, ring;
};
struct grower {
    const struct links *l;
    int rings, wanted;
    int *seen; /* [ncells] the last stencil that had the cell as a member */
    int stamp;
    int n, room; /* member[0] is the cell itself */
    struct member *member;
};
status grower_make(const struct links *l, int rings, struct grower *g);
void grower_free(struct grower *g);
status grower_run(struct grower *g, int cell);

/* Fills stencils and corners. mirror_of: [links] mirror, -1: none here. */
status stencil_make(struct polyhedra *m, struct grower *g, const int *local, const int *mirror_of);

/* Fills all geometry; link_of: [faces], mirror_link: [mirrors] of the links. */
status geometry_make(struct polyhedra *m, const struct links *l, const int *link_of, const int *mirror_link, int order);

status lines_make(double **line, int count, long n, const char *what);
void lines_free(double **line, int count);

#endif
